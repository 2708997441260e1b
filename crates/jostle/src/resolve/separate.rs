//! Remaining overlap is pushed apart. Only positions change, so no energy is
//! made; each particle gives way by the other's share of the mass.

use crate::contacts::Contact;
use crate::motion::Motions;

/// Overlap that is left alone, as a share of the sum of radii: a resting contact
/// should stay one.
const SLOP: f32 = 0.003;

/// Share of the overlap that is removed at once.
const SOFTNESS: f32 = 0.35;

/// Most that one particle is pushed at once, as a share of the smaller radius: what
/// is pushed further could come out on the other side of something thin.
const MOST: f32 = 0.2;

/// Directions for centres that coincide: sixteen points of the unit circle, in
/// an order that sends neighbours apart.
const DIRECTIONS: [[f32; 2]; 16] = [
    [1.0, 0.0],
    [-0.707_106_77, 0.707_106_77],
    [0.0, -1.0],
    [0.707_106_77, 0.707_106_77],
    [-1.0, 0.0],
    [0.707_106_77, -0.707_106_77],
    [0.0, 1.0],
    [-0.707_106_77, -0.707_106_77],
    [0.923_879_5, 0.382_683_43],
    [-0.923_879_5, 0.382_683_43],
    [0.382_683_43, -0.923_879_5],
    [0.382_683_43, 0.923_879_5],
    [-0.923_879_5, -0.382_683_43],
    [0.923_879_5, -0.382_683_43],
    [-0.382_683_43, 0.923_879_5],
    [-0.382_683_43, -0.923_879_5],
];

/// Moves two overlapping particles apart.
pub fn push_apart(contact: &mut Contact, motions: &Motions, radii: &[f32]) {
    let [a, b] = contact.places.map(|place| motions.position(place));
    let offset = [0, 1].map(|k| b[k] - a[k] + contact.image[k]);
    let square = offset[0] * offset[0] + offset[1] * offset[1];
    if square >= contact.reach * contact.reach {
        return;
    }
    contact.touched = true;
    let length = square.sqrt();
    let excess = contact.reach - length - SLOP * contact.reach;
    if excess <= 0.0 {
        return;
    }
    let normal = if length > 0.0 {
        offset.map(|v| v / length)
    } else {
        DIRECTIONS[(contact.places[1] - contact.places[0]) as usize % DIRECTIONS.len()]
    };
    let [inverse_a, inverse_b] = contact.inverse_masses;
    let smaller =
        contact.places.map(|place| radii[place as usize]).into_iter().fold(f32::MAX, f32::min);
    let wanted = SOFTNESS * excess / (inverse_a + inverse_b);
    let push = wanted.min(MOST * smaller / inverse_a.max(inverse_b));
    if inverse_a > 0.0 {
        let position = [0, 1].map(|k| a[k] - normal[k] * push * inverse_a);
        motions.set_position(contact.places[0], position);
    }
    if inverse_b > 0.0 {
        let position = [0, 1].map(|k| b[k] + normal[k] * push * inverse_b);
        motions.set_position(contact.places[1], position);
    }
}
