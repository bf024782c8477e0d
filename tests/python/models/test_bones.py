"""The phalanges of `models.bone_of`: inside the skin, of the sizes published, usable by a body."""

from __future__ import annotations

import re

import numpy as np
import pytest
import quasirigid as qr
from quasirigid.models.bones import LENGTHS
from shapes import TURN, ball
from shared_meshes import hand_file

SCANNED = ("libhand_right_middle_1500", "webxr_right_middle_1500", "makehuman_female_right_middle_1500")


def finger_named(name: str) -> qr.Surface:
    if name == "fingertip":
        return qr.models.fingertip()
    if name == "finger":
        return qr.models.finger()
    return qr.read_surface(hand_file(name), unit="m")


def bones_in(bone: qr.Surface) -> list[np.ndarray]:
    """Vertices (m) of each phalanx, the distal one first."""
    patches = bone.patches(np.arange(len(bone.vertices)))
    return [np.asarray(bone.vertices)[patch] for patch in patches]


@pytest.mark.parametrize(
    ("name", "count"), [("fingertip", 2), ("finger", 3), *((name, 2) for name in SCANNED)]
)
def test_a_bone_lies_inside_the_skin_with_the_tissue_promised(name: str, count: int) -> None:
    finger = finger_named(name)
    bone = qr.models.bone_of(finger)
    assert bone.is_closed
    assert 160 <= len(bone.vertices) <= 300
    phalanges = bones_in(bone)
    assert len(phalanges) == count
    tissue = -qr.Obstacle.mesh(finger.vertices, finger.faces).signed_distance(bone.vertices)[0]
    assert tissue.min() >= 1e-3
    # Lengths along the finger: the distal phalanx, then what fits; the tip's tissue beyond.
    beyond, distal, *_ = LENGTHS["middle"]
    assert np.ptp(phalanges[0][:, 1]) == pytest.approx(distal, rel=0.02)
    tip = finger.vertices[:, 1].max() - phalanges[0][:, 1].max()
    assert tip == pytest.approx(beyond, abs=0.3e-3)
    # The nail's side has the thinner tissue.
    middle = phalanges[0][:, 1].mean()
    near = np.abs(finger.vertices[:, 1] - middle) < 2e-3
    here = np.abs(phalanges[0][:, 1] - middle) < 2e-3
    above = finger.vertices[near, 2].max() - phalanges[0][here, 2].max()
    below = phalanges[0][here, 2].min() - finger.vertices[near, 2].min()
    assert 1.5e-3 < above < 0.75 * below


def test_a_turned_finger_gets_the_turned_bone() -> None:
    finger = qr.models.fingertip(edge_length=2e-3)
    shift = np.array([0.4, -0.2, 1.3])
    bone = qr.models.bone_of(finger)
    turned = qr.models.bone_of(finger.moved(TURN, shift), palmar=TURN @ [0, 0, -1])
    np.testing.assert_allclose(turned.vertices, bone.vertices @ TURN.T + shift, atol=1e-9)


def test_tip_and_axis_may_be_given_where_no_cut_tells_them() -> None:
    vertices, faces = ball(8e-3, 3)
    unit = (vertices - [0, 0, 8e-3]) / 8e-3
    blunt = (1 - unit[:, 1:2] ** 4) ** 0.25 / np.maximum(np.hypot(unit[:, :1], unit[:, 2:]), 1e-9)
    pill = qr.Surface(unit * np.hstack([9e-3 * blunt, np.full_like(blunt, 20e-3), 9e-3 * blunt]), faces)
    with pytest.raises(qr.SurfaceError, match="no flat cut"):
        qr.models.bone_of(pill)
    bone = qr.models.bone_of(pill, tip=[0, 20e-3, 0])
    assert bone.vertices[:, 1].max() == pytest.approx(20e-3 - LENGTHS["middle"][0], abs=0.1e-3)
    other = qr.models.bone_of(pill, axis=[0, -1, 0])
    assert other.vertices[:, 1].min() == pytest.approx(-20e-3 + LENGTHS["middle"][0], abs=0.1e-3)


def test_digit_scale_and_element_size_change_what_they_say() -> None:
    finger = qr.models.finger()
    little = bones_in(qr.models.bone_of(finger, digit="little"))
    assert [np.ptp(part[:, 1]) for part in little] == pytest.approx(LENGTHS["little"][1:], rel=0.02)
    small = bones_in(qr.models.bone_of(finger, scale=0.9))
    assert np.ptp(small[1][:, 1]) == pytest.approx(0.9 * LENGTHS["middle"][2], rel=0.02)
    assert len(bones_in(qr.models.bone_of(finger, digit="thumb"))) == 2
    fine = qr.models.bone_of(finger, element_size=1.5e-3)
    assert np.linalg.norm(
        np.diff(fine.vertices[fine.faces[fine.faces.max(axis=1) < 80]], axis=1), axis=2
    ).mean() == pytest.approx(1.5e-3, rel=0.15)


def test_the_bone_fills_the_share_of_a_fingertip_that_is_stated() -> None:
    finger = qr.models.finger(edge_length=1e-3)
    bone = qr.models.bone_of(finger, element_size=0.8e-3)
    crease = finger.vertices[:, 1].max() - 0.0213

    def beyond_the_crease(surface: qr.Surface) -> float:
        # What is cut off collapses into the plane of the crease and encloses nothing.
        vertices = np.array(surface.vertices)
        vertices[:, 1] = np.maximum(vertices[:, 1], crease)
        a, b, c = (vertices[surface.faces[:, corner]] for corner in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    assert beyond_the_crease(bone) / beyond_the_crease(finger) == pytest.approx(0.14, abs=0.01)


def test_what_does_not_fit_is_refused_with_the_reason() -> None:
    finger = qr.models.fingertip(edge_length=2e-3)
    with pytest.raises(qr.SurfaceError, match=r"expected at least 4\.00 mm of tissue"):
        qr.models.bone_of(finger, min_thickness=4e-3)
    with pytest.raises(qr.SurfaceError, match="no phalanx fits"):
        qr.models.bone_of(qr.Surface(0.2 * finger.vertices, finger.faces))
    with pytest.raises(qr.SurfaceError, match="give `palmar`"):
        qr.models.bone_of(finger, palmar=[0, 1, 0.1])
    with pytest.raises(qr.SurfaceError, match="digit is 'toe'"):
        qr.models.bone_of(finger, digit="toe")
    with pytest.raises(qr.SurfaceError, match="scale is 0"):
        qr.models.bone_of(finger, scale=0.0)
    with pytest.raises(qr.SurfaceError, match="open"):
        qr.models.bone_of(qr.Surface(finger.vertices, finger.faces[1:]))


MARKED = r"`cut` marks \d+ of the 506 vertices"
MISTAKES = {
    "a tip that is nan": ({"tip": [np.nan] * 3}, r"tip is \[nan, nan, nan\], expected three finite numbers"),
    "a tip in mm": ({"tip": [0, 30, 0]}, r"no skin .* mm behind the tip \(0, 30, 0\) m.*check `tip`"),
    "a tip far off": ({"tip": np.ones(3)}, r"no skin .* mm behind the tip \(1, 1, 1\) m"),
    "the number of a tip": ({"tip": 12}, "tip is 12, expected three finite numbers"),
    "an axis reversed": ({"axis": [0, -1, 0]}, "`axis` runs from the root to the tip"),
    "an axis of no length": ({"axis": [0, 0, 0]}, "axis is .*, expected a direction"),
    "an axis that is nan": ({"axis": [0, np.nan, 0]}, "axis is .*, expected three finite numbers"),
    "an axis in the plane": ({"axis": [0, 1]}, "axis is .*, expected three finite numbers"),
    "everything cut": ({"cut": np.ones(506, dtype=bool)}, MARKED),
    "nothing cut": ({"cut": np.zeros(506, dtype=bool)}, MARKED),
    "a short cut": ({"cut": [True] * 3}, "`cut` has 3 entries, but the skin has 506 vertices"),
    "a cut of columns": ({"cut": np.ones((506, 1), dtype=bool)}, r"`cut` has shape \(506, 1\)"),
    "a pad of no length": ({"palmar": [0, 0, 0]}, "palmar is .*, expected a direction"),
    "a pad that is nan": ({"palmar": [np.nan, 0, 0]}, "palmar is .*, expected three finite numbers"),
    "a scale in words": ({"scale": "1"}, "scale is '1', expected a number from 0.3 to 2"),
    "a giant": ({"scale": 5.0}, "scale is 5.0, expected a number from 0.3 to 2"),
    "a list of digits": ({"digit": ["middle"]}, r"digit is \['middle'\], expected one of thumb"),
    "elements as long as a bone": ({"element_size": 0.02}, "element_size is 0.02 m, expected .*quarter"),
    "elements of a micrometre": ({"element_size": 1e-6}, r"element_size is 1e-06 m, .*\(20000 vertices\)"),
    "no number for the tissue": ({"min_thickness": np.nan}, "min_thickness is nan"),
}


@pytest.mark.parametrize(("arguments", "message"), MISTAKES.values(), ids=MISTAKES.keys())
def test_a_mistaken_argument_is_refused_by_name(arguments: dict[str, object], message: str) -> None:
    finger = qr.models.fingertip(edge_length=2e-3)
    assert len(finger.vertices) == 506
    with pytest.raises(qr.SurfaceError, match=message):
        qr.models.bone_of(finger, **arguments)  # type: ignore[arg-type]


def test_a_cut_that_is_no_mask_is_of_the_wrong_kind() -> None:
    finger = qr.models.fingertip(edge_length=2e-3)
    with pytest.raises(TypeError, match=r"`cut` has dtype int64, .* np\.isin"):
        qr.models.bone_of(finger, cut=np.arange(506))


def test_the_length_of_a_direction_does_not_matter() -> None:
    finger = qr.models.fingertip(edge_length=2e-3)
    bone = qr.models.bone_of(finger, axis=[0, 1, 0])
    for length in (1e-300, 1e300):
        other = qr.models.bone_of(finger, axis=[0, length, 0], palmar=[0, 0, -length])
        np.testing.assert_array_equal(other.vertices, bone.vertices)


def test_a_body_takes_it_and_coarser_elements_cost_little() -> None:
    """The default against elements a little over half the size: the force of a press changes by under 2 %."""
    tip = qr.models.fingertip(edge_length=2.2e-3)
    tip = tip.with_skin_mask(qr.skin_without_caps(tip))
    pad = np.flatnonzero(tip.skin_mask & (tip.vertices[:, 2] < tip.vertices[:, 2].min() + 4e-3))
    plate = qr.Obstacle.half_space([0, 0, -0.05], [0, 0, 1])
    forces = []
    for element_size in (None, 1.0e-3):
        bone = qr.models.bone_of(tip, element_size=element_size)
        response = qr.Body(bone=bone, fixed=~tip.skin_mask)
        skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response).prepared(tip, pad)
        forces.append(qr.press(tip, plate, skin, [0, 0, 1], depth=1.12e-3).force[2])
    assert forces[0] == pytest.approx(forces[1], rel=0.02)


def test_a_cut_out_finger_knows_its_cut() -> None:
    finger = qr.models.finger(edge_length=2e-3)
    part = qr.cut_out(finger, keep=finger.vertices[:, 1] > 0.045)
    bone = qr.models.bone_of(part)
    same = qr.models.bone_of(part.surface, cut=part.fixed)
    np.testing.assert_array_equal(bone.vertices, same.vertices)


def test_bones_end_at_the_joints_that_are_given() -> None:
    finger = qr.models.finger(edge_length=1.5e-3)
    tip = finger.vertices[:, 1].max()
    joints = [[0.0, tip - 0.041, 0.0], [0.0, tip - 0.020, 0.0], [0.0, tip, 0.0]]
    bones = bones_in(qr.models.bone_of(finger, joints=joints))
    assert len(bones) == 2
    # Half a millimetre of cartilage on either side of a joint.
    ends = [(tip - bone[:, 1]).max() for bone in bones], [(tip - bone[:, 1]).min() for bone in bones]
    np.testing.assert_allclose(ends[0], [0.0195, 0.0405], atol=1e-6)
    np.testing.assert_allclose(ends[1], [LENGTHS["middle"][0], 0.0205], atol=1e-6)
    turned = qr.models.bone_of(
        finger.moved(TURN, [0.1, 0.2, 0.3]),
        joints=joints @ TURN.T + [0.1, 0.2, 0.3],
        palmar=TURN @ [0, 0, -1],
    )
    expected = qr.models.bone_of(finger, joints=joints).vertices @ TURN.T + [0.1, 0.2, 0.3]
    np.testing.assert_allclose(turned.vertices, expected, atol=1e-9)


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        ([[0, 0.05, 0]], r"joints is .*, expected \(k, 3\)"),
        ([0.05, 0.07], r"joints is .*, expected \(k, 3\)"),
        ([[0, np.nan, 0], [0, 0.07, 0]], "finite numbers"),
        ("tip", "joints is 'tip'"),
        ([[0, 0.03, 0], [0, 0.01, 0], [0, 0.07, 0]], "expected rising numbers, the joints from the root"),
    ],
)
def test_joints_that_are_none_are_refused(joints: object, message: str) -> None:
    with pytest.raises(qr.SurfaceError, match=message):
        qr.models.bone_of(qr.models.finger(edge_length=3e-3), joints=joints)  # type: ignore[arg-type]


def test_a_bone_too_near_to_the_skin_says_what_would_pass() -> None:
    finger = qr.models.fingertip(edge_length=2e-3)
    with pytest.raises(qr.SurfaceError, match=r"expected at least 2\.30 mm") as refused:
        qr.models.bone_of(finger, min_thickness=2.3e-3)
    remedies = re.findall(r"(scale|min_thickness)=([\d.e-]+)", str(refused.value))
    assert "min_thickness" in dict(remedies)
    for name, value in remedies:
        asked = {"min_thickness": 2.3e-3, name: float(value)}
        assert qr.models.bone_of(finger, **asked).is_closed
