"""The words of docs/paper.md."""

PAGE = """\
# The paper redone

Xie, Kanai, Date 2011, "Simulating Deformable Contact Property of Digital Hand Skin" (*the paper*): its
equations, constants and cases, with this package. Written by `python docs/scripts/paper.py`, which needs the
test meshes (`QUASIRIGID_DATA`). G = 60 kPa, nu = 0.5 throughout, as in the paper. Its hand and products are
not public, so forces can be compared in kind and not digit by digit. The skins here are MakeHuman's (CC0): a
female middle finger of {finger_count} vertices, as the paper's finger of about 1,500, and a male hand of
{hand_count}, as its dense hand of about 53,000. The paper names no product; here a flat slab as a phone
(made for this collection, CC0) and a computer mouse (The Base Mesh, CC0). Depths are the largest overlap of
skin and product before, the paper's penetration depth.

What came out:

- With the printed constants Lemke's method ends on a ray at every depth that the paper shows. On the finger
  the last depth of the sweep that solves is {last:.1f} mm.
- The half-space solves everywhere, and everywhere loses volume. The body, with its bone inside, solves too,
  keeps volume up to its mesh error, and bulges at the sides.
- Where the paper needed 340 s, 4.8 s and 438 ms for set-up, collision and LCP of a finger, a second and a
  millisecond each are enough here; collision and LCP of the palm of the dense hand take tens of ms.

## Responses (the paper's figure 5)

f' = f - g, with f = K / r and g = a exp(-r²/2c²), a = 0.8 mm/N, c = 5 mm. The paper prints no cutoff. Its
condition of no net volume (eq. 5) needs one: with a cutoff of 15 mm it asks for a = {balance:.3f} mm/N, the
printed number, so 15 mm is taken to be meant.

![The kernel, and what it answers to waves of pressure](paper_kernel.png)

Right: what a wave of pressure gets as displacement. Below zero the skin comes out where it is pushed in,
and a contact that is wide enough need not have an equilibrium. Without a cutoff this is so for wavelengths
of {endless_band} mm, with it from {cut_band} mm on. A height up to {highest:.2f} mm/N would be well posed
without a cutoff, but gives back half of the volume only.

## Fingertip, {depth:.2f} mm (the paper's figure 7)

The finger is pitched by 25° over the slab. The printed kernels and "one-rings" are solved as in the paper:
pressure even over one-rings (eq. 8), three rings around the penetrating vertices, gaps of the undeformed
skin, Lemke. The half-space and the body are refined around the contact (to {refined} vertices for the
body). "Gaussian, balanced" is the paper's idea made well posed: c = 8 mm, cutoff 15 mm, a from its eq. 5.
"Towards product" is the largest movement of skin against the product's way, "outwards" that along the
skin's normal, "volume" the change under the skin to first order.

{finger_table}

![The finger, its cut, its pressure, and close ups](paper_finger.png)

- The paper reports a solved contact at this depth, and here its kernel ends on a ray: Lemke's method finds
  forces z >= 0 with z'Rz < 0, so R is not copositive, and there may be no solution, one or several. Why the
  paper's run ended cannot be told from its text. Cutoff or none is the same ray: the vertices that carry it
  are at most {ray_reach:.0f} mm apart.
- The paper's bulges in front and behind come with its kernel: the balanced Gaussian and the printed
  constants at 0.3 mm (where they solve) move skin towards the product around the contact. The body does
  not: its tissue goes to the sides and to the back of the finger, where the bone does not hold it.
- The half-space knows no bone and keeps no volume, so it is softer than the body. Its skin moves along the
  product's normal alone; what it has "outwards" is that movement on slanting skin.
- The balanced Gaussian keeps volume on a plane only; on a finger narrower than its cutoff it loses some. It
  is stiffer than the body because it lifts the skin right beside the force, where the body does not.

Endings of Lemke's method on the printed kernel (cutoff 15 mm), by the rings around the penetrating
vertices, and the sum of forces where it solves:

{rings}

On the penetrating vertices alone it solves a little further, to nine times the half-space's force: an
ending "solved" on too small a set says nothing.

## Force and area over the depth (the paper's figure 8)

![Force and area over the largest overlap; a cross: no answer beyond](paper_sweep.png)

The paper finds both about linear. The area is, here too: from 0.6 mm on it grows with the power
{half_power[1]:.2f} of the depth on the half-space and {body_power[1]:.2f} on the body. The force is not:
powers {half_power[0]:.2f} and {body_power[0]:.2f}, because the area grows under it (Hertz has 1.5 for a
ball); a short enough stretch of such a curve looks straight. The one-rings' area goes in steps, as whole
vertices join.

## Fingertip and palm of the dense hand (the paper's figure 9)

The mesh is taken as given, as in the paper. The fingertip is the index finger, taken out with `qr.cut_out`
({tip_count} vertices) so that the other fingers do not meet the slab first, with the bone of
`models.bone_of`.

{tip_table}

![The fingertip at three depths](paper_fingertip.png)

The palm is that of the whole hand, {hand_count} vertices, flat and open, on the mouse. As a body it holds
five rods, four metacarpals on the hand's joints and one across the wrist, drawn for this page and not
measured; it is solved on a coarse mesh with edges of {palm_edges:.0f} mm and prepared for {palm_nodes}
vertices{palm_setup}.

{palm_table}

![The palm at three depths](paper_palm.png)

- The printed constants {at_depths} at the six depths. The paper shows pictures without figures here, so
  there is no force to compare.
- What moves towards the product on the palm is the fingers, which have no bones in this body and lean; the
  bulge is at the hand's edge, in the close ups.
- The body is stiffer than the half-space, up to {stiffer:.1f} times, because it has bone under it and no
  volume to give.
- On the palm up to 0.03 mm of overlap is left after the contact, about 1 % of the depth: the product is
  curved between the vertices of the skin.

Every body's own estimate of its error in force is at most {body_error:.1%}. All of it is linear: at 2.8 mm
and 12 N a real fingertip has stiffened long ago.

## Times

Set-up as wall time, the stages from `contact.timings`, each the least of repeated runs on {cores} cores,
which other work shared. The paper's are those of a Core i7 of 2011; a part of each ratio is fifteen years of
processors. Its set-up is for one finger, 438 ms was its LCP at 1.12 mm, 111 to 211 ms those of its sweep. It
does not say how many vertices its collision looked at; its hand had about 13,000, so the last collision here,
on {hand_count}, errs on the paper's side.

{times}

The printed kernel is slower to set up than the half-space because triangles that its cutoff cuts need
quadrature. A press computes only the vertices that may touch. The refined meshes have finer contacts than
the paper's.
"""
