//! Skin and bone as nodes, elements and closed surfaces without units.

use nalgebra::Vector3;

use crate::response::body::check::tissue::area_vectors;
use crate::response::body::equations::assemble::DiscreteBody;
use crate::response::body::equations::element::{Element, NO_COLUMN};
use crate::response::body::equations::incompressible::ClosedSurface;
use crate::response::body::equations::kelvin::Kelvin;
use crate::response::body::equations::triangle::Triangle;
use crate::response::body::solve::Body;
use crate::surface::checked::Surface;

impl Body {
    /// Nodes, faces and closed surfaces in units of `length`.
    pub(crate) fn discretize(
        &self,
        skin: &Surface,
        length: f64,
        poisson_ratio: f64,
        fixed: &[bool],
        nodes: &[usize],
    ) -> (DiscreteBody, Vec<ClosedSurface>) {
        let skin_count = skin.vertices().len();
        let origin = skin.vertices().iter().sum::<Vector3<f64>>() / skin_count as f64;
        let bones = self.bone.iter().flat_map(|bone| bone.vertices());
        let points: Vec<Vector3<f64>> =
            bones.chain(skin.vertices()).map(|vertex| (vertex - origin) / length).collect();
        let is_moving =
            std::iter::repeat_n(false, self.bone_count()).chain(fixed.iter().map(|fixed| !fixed)).collect();
        let kelvin = Kelvin::new(poisson_ratio);
        let elements = self.elements(skin, &points, length, fixed, nodes);
        let surfaces = self.closed_surfaces(skin, length);
        (DiscreteBody { kelvin, points, is_moving, elements, load_count: nodes.len() }, surfaces)
    }

    /// Faces of skin and bone between `points`, with the columns that their hats go to.
    fn elements(
        &self,
        skin: &Surface,
        points: &[Vector3<f64>],
        length: f64,
        fixed: &[bool],
        nodes: &[usize],
    ) -> Vec<Element> {
        let bone_count = self.bone_count() as u32;
        let mut slots = vec![NO_COLUMN; skin.vertices().len()];
        nodes.iter().enumerate().for_each(|(slot, &node)| slots[node] = slot as u32);

        let skin_elements = skin.faces().iter().map(|face| {
            let is_held = face.iter().all(|&v| fixed[v as usize]);
            let nodes = face.map(|v| v + bone_count);
            Element {
                triangle: Triangle::new(nodes.map(|node| points[node as usize])),
                nodes,
                moving: face.map(|v| if fixed[v as usize] { NO_COLUMN } else { v + bone_count }),
                supported: if is_held { nodes } else { [NO_COLUMN; 3] },
                loaded: face.map(|v| slots[v as usize]),
                load_scales: face.map(|v| length * length / skin.vertex_areas()[v as usize]),
                is_skin: true,
            }
        });
        let bone_elements = self.bone.iter().flat_map(|bone| bone.faces()).map(|&face| Element {
            triangle: Triangle::new(face.map(|v| points[v as usize])),
            nodes: face,
            moving: [NO_COLUMN; 3],
            supported: face,
            loaded: [NO_COLUMN; 3],
            load_scales: [0.0; 3],
            is_skin: false,
        });
        skin_elements.chain(bone_elements).collect()
    }

    /// The skin and each bone, areas in units of `length`².
    fn closed_surfaces(&self, skin: &Surface, length: f64) -> Vec<ClosedSurface> {
        let bone_count = self.bone_count();
        let scaled = |surface: &Surface| -> Vec<Vector3<f64>> {
            area_vectors(surface).iter().map(|area| area / (length * length)).collect()
        };
        let mut surfaces = vec![ClosedSurface {
            nodes: (0..skin.vertices().len()).map(|v| (bone_count + v) as u32).collect(),
            area_vectors: scaled(skin),
            is_bone: false,
        }];
        if let Some(bone) = &self.bone {
            let areas = scaled(bone);
            let topology = bone.topology();
            for component in 0..topology.component_count() {
                let members: Vec<usize> =
                    (0..areas.len()).filter(|&v| topology.vertex_component(v) == component).collect();
                surfaces.push(ClosedSurface {
                    nodes: members.iter().map(|&v| v as u32).collect(),
                    area_vectors: members.iter().map(|&v| areas[v]).collect(),
                    is_bone: true,
                });
            }
        }
        surfaces
    }
}
