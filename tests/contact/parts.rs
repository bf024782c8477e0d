//! What parts of the skin carry of a contact.

use quasirigid::contact::{ContactError, ContactOptions, solve_contact};
use quasirigid::obstacle::Obstacle;

use crate::{UP, ball, half_space};

#[test]
fn an_area_or_a_mask_that_does_not_fit_is_named() {
    let surface = ball(8e-3, 2);
    let plate = Obstacle::half_space(0.5e-3 * UP, UP).expect("a valid obstacle");
    let [contact, refined] = [ContactOptions::on_given_mesh(), ContactOptions::default()]
        .map(|options| solve_contact(&surface, &plate, &half_space(), &options).expect("a valid request"));
    for area in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(contact.mean_pressure(area), Err(ContactError::Area { .. })));
    }
    let whole = refined.surface().vertices().len();
    let refused = refined.part(&[true; 3]).unwrap_err();
    assert_eq!(refused, ContactError::MaskLength { found: 3, given: 162, whole });
    assert_eq!(refined.part(&vec![true; whole]).unwrap(), refined.part(&[true; 162]).unwrap());
    assert_eq!(refined.part(&[true; 162]).unwrap().resultant, refined.resultant);
}
