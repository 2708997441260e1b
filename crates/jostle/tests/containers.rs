//! Containers: their walls agree with the nearest position inside, whatever their shape.

use jostle_scenes::random::Random;
use jostle_world::Container;

/// One of each kind.
const ALL: [Container; 4] = [
    Container::None,
    Container::Box { min: [-9.0, 2.0], max: [7.0, 11.0] },
    Container::Circle { center: [3.0, -1.0], radius: 8.0 },
    Container::Torus { size: [6.0, 9.0] },
];

#[test]
fn a_disc_at_the_nearest_position_inside_overlaps_no_wall() {
    let mut random = Random::new(1);
    for container in ALL {
        assert_eq!(container.has_sides(), container.sides().count() > 0);
        for _ in 0..1000 {
            let position = [random.between(-30.0, 30.0), random.between(-30.0, 30.0)];
            let radius = random.between(0.0, 2.0);
            let inside = container.clamp(position, radius).map(f64::from);
            let radius = f64::from(radius);
            let exact = container.clamp_exactly(position.map(f64::from), radius);
            for (wall, side) in container.sides() {
                assert_eq!(container.side(wall), Some(side));
                assert!(side.contact(wall, inside, radius).gap >= -1e-12, "{container:?}");
                assert!(side.contact(wall, exact, radius).gap >= -1e-12, "{container:?}");
            }
        }
    }
}

#[test]
fn normals_point_inwards_and_gaps_are_distances() {
    let mut random = Random::new(2);
    for container in ALL {
        for _ in 0..1000 {
            let position = [random.between(-30.0, 30.0), random.between(-30.0, 30.0)];
            let position = position.map(f64::from);
            for (wall, side) in container.sides() {
                let [here, smaller] = [1.0, 0.5].map(|radius| side.contact(wall, position, radius));
                assert!((smaller.gap - here.gap - 0.5).abs() < 1e-12);
                let moved = [0, 1].map(|k| position[k] + 0.25 * here.normal[k]);
                let gained = side.contact(wall, moved, 1.0).gap - here.gap;
                // Near the centre of a circle the other side is nearer after the displacement.
                let is_near_center = here.gap > 6.5;
                assert!(
                    (gained - 0.25).abs() < 1e-12 || is_near_center,
                    "{container:?} {position:?}"
                );
            }
        }
    }
}

#[test]
fn a_container_has_sides_or_a_period() {
    for container in ALL.into_iter().filter(|all| *all != Container::None) {
        assert_ne!(container.has_sides(), !container.period().is_none(), "{container:?}");
    }
}
