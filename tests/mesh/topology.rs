//! Neighbourhoods, borders and components of sound meshes.

use nalgebra::Vector3;
use quasirigid::mesh::{Topology, check, component_volumes};

use crate::common::{Random, grid, icosphere, joined};
use crate::{shifted, tetrahedron};

fn sorted(row: &[u32]) -> Vec<u32> {
    let mut row = row.to_vec();
    row.sort_unstable();
    row
}

#[test]
fn one_rings_of_a_tetrahedron_hold_the_three_other_vertices() {
    let (vertices, faces) = tetrahedron();
    let topology = check(&vertices, &faces).unwrap();
    for vertex in 0..4u32 {
        let others: Vec<u32> = (0..4).filter(|other| *other != vertex).collect();
        assert_eq!(sorted(topology.neighbours(vertex as usize)), others);
        let around: Vec<u32> = (0..4).filter(|face| faces[*face as usize].contains(&vertex)).collect();
        assert_eq!(sorted(topology.faces_around(vertex as usize)), around);
    }
    assert_eq!((topology.vertex_count(), topology.face_count(), topology.edge_count()), (4, 4, 6));
    assert!(topology.is_closed() && topology.is_component_closed(0));
    assert_eq!(topology.component_count(), 1);
    assert_eq!(topology.across(0, 1), Some(3), "edge 2-1 of the floor");
}

#[test]
fn rings_run_counter_clockwise_and_on_a_border_from_border_to_border() {
    let (vertices, faces) = grid(2, 2, 1.0);
    let topology = check(&vertices, &faces).unwrap();
    for vertex in 0..9 {
        let ring = topology.neighbours(vertex);
        let around = topology.faces_around(vertex);
        let open = vertex != 4;
        assert_eq!(ring.len(), around.len() + usize::from(open));
        let wedges = if open { ring.len() - 1 } else { ring.len() };
        for i in 0..wedges {
            let [a, b] = [ring[i], ring[(i + 1) % ring.len()]].map(|other| vertices[other as usize]);
            assert!((a - vertices[vertex]).cross(&(b - vertices[vertex])).z > 0.0);
            let face = faces[around[i] as usize];
            assert!(face.contains(&ring[i]) && face.contains(&ring[(i + 1) % ring.len()]));
        }
    }
}

#[test]
fn the_border_of_a_grid_is_one_loop_with_the_surface_on_its_left() {
    let (vertices, faces) = grid(2, 1, 1.0);
    let topology = check(&vertices, &faces).unwrap();
    assert_eq!(topology.boundary_loops(), [vec![0, 1, 2, 5, 4, 3]]);
    assert!(!topology.is_closed());
}

#[test]
fn single_faces_and_pairs_of_faces_pass() {
    let (vertices, faces) = tetrahedron();
    assert_eq!(check(&vertices[..3], &faces[..1]).unwrap().boundary_loops(), [vec![0, 2, 1]]);
    let pair = check(&vertices, &faces[..2]).unwrap();
    assert_eq!(pair.boundary_loops().len(), 1);
    assert_eq!(pair.edge_count(), 5);
}

#[test]
fn components_are_numbered_by_their_first_faces() {
    let mesh = joined(&tetrahedron(), &shifted(&tetrahedron(), Vector3::new(5.0, 0.0, 0.0)));
    let mesh = joined(&mesh, &shifted(&grid(1, 1, 1.0), Vector3::new(0.0, 9.0, 0.0)));
    let topology = check(&mesh.0, &mesh.1).unwrap();
    assert_eq!(topology.face_components(), [0, 0, 0, 0, 1, 1, 1, 1, 2, 2]);
    assert_eq!([0, 4, 8].map(|vertex| topology.vertex_component(vertex)), [0, 1, 2]);
    assert_eq!([0, 1, 2].map(|label| topology.is_component_closed(label)), [true, true, false]);
    let volumes = component_volumes(&mesh.0, &mesh.1, &topology);
    assert!((volumes[0] - 1.0 / 6.0).abs() < 1e-15 && (volumes[1] - 1.0 / 6.0).abs() < 1e-14);
    assert!(volumes[2].is_nan());
}

fn counts(topology: &Topology) -> [usize; 4] {
    let loops = topology.boundary_loops();
    [topology.edge_count(), loops.len(), loops.iter().map(Vec::len).sum(), topology.component_count()]
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig { cases: 32, failure_persistence: None, ..Default::default() })]

    #[test]
    fn renumbering_vertices_and_faces_changes_no_neighbourhood(seed in 0u64..1000) {
        let mesh = joined(&grid(4, 3, 1.0), &shifted(&icosphere(1.0, 1), Vector3::new(0.0, 0.0, 5.0)));
        let mut random = Random(seed);
        let to = random.permutation(mesh.0.len());
        let mut vertices = mesh.0.clone();
        mesh.0.iter().zip(&to).for_each(|(point, new)| vertices[*new] = *point);
        let order = random.permutation(mesh.1.len());
        let faces: Vec<[u32; 3]> = order
            .iter()
            .map(|face| {
                let mut corners = mesh.1[*face].map(|vertex| to[vertex as usize] as u32);
                corners.rotate_left((random.next() * 3.0) as usize);
                corners
            })
            .collect();
        let (before, after) = (check(&mesh.0, &mesh.1).unwrap(), check(&vertices, &faces).unwrap());
        proptest::prop_assert_eq!(counts(&before), counts(&after));
        for vertex in 0..mesh.0.len() {
            let renumbered: Vec<u32> =
                before.neighbours(vertex).iter().map(|other| to[*other as usize] as u32).collect();
            proptest::prop_assert_eq!(sorted(&renumbered), sorted(after.neighbours(to[vertex])));
        }
    }
}
