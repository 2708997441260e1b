//! A world in bytes goes on as the world itself does; other bytes are refused.

use std::sync::LazyLock;

use jostle_base::bytes::{HEAD, checksum};
use jostle_base::{Method, Settings};
use jostle_scenes::{SCENES, random::Random};
use jostle_world::forces::{Attractor, Gravitation, Law, Pole, Spring, Springs, Thermostat};
use jostle_world::{
    Container, Influence, OnTouch, Particles, Sides, Surface, Wall, World, WorldSettings,
};
use proptest::prelude::*;

use crate::common::worlds::{boxed, forced, restored, run, still};

/// All that can be asked of a world.
fn assert_same(a: &World, b: &World, of: &str) {
    assert!(a.bodies().particles().unwrap() == b.bodies().particles().unwrap(), "{of}: particles");
    assert_eq!(a.settings(), b.settings(), "{of}");
    assert_eq!(a.forces().unwrap(), b.forces().unwrap(), "{of}");
    assert_eq!(a.contacts().unwrap(), b.contacts().unwrap(), "{of}");
    assert_eq!(a.wall_contacts().unwrap(), b.wall_contacts().unwrap(), "{of}");
    assert_eq!(a.time(), b.time(), "{of}");
    assert_eq!(a.momentum(), b.momentum(), "{of}: the order within");
    assert_eq!(
        (a.events(), a.record().totals().collisions),
        (b.events(), b.record().totals().collisions),
        "{of}"
    );
    assert_eq!(a.snapshot().unwrap(), b.snapshot().unwrap(), "{of}");
}

/// Every kind of force; the first spring breaks soon.
fn forces(count: u32) -> Vec<Influence> {
    let tie = |i: u32| Spring {
        pair: [i, (i * 7 + 1) % count].map(jostle_base::Id::from),
        length: 3.0,
        stiffness: 20.0,
        damping: 0.1,
        max_stretch: if i == 2 { 0.01 } else { f32::INFINITY },
    };
    let springs = (2..40).map(tie).collect();
    let attract = |pole, law| Influence::Attractor(Attractor { pole, strength: 0.5, law });
    vec![
        attract(Pole::Point([4.0, -6.0]), Law::Harmonic),
        attract(Pole::Particle(17), Law::InverseSquare),
        Influence::Gravitation(Gravitation { g: 0.01, softening: 0.1, theta: 0.6 }),
        Influence::Springs(Springs(springs)),
        Influence::Thermostat(Thermostat { speed: 2.0, rate: 0.3 }),
    ]
}

/// A crowd under gravity with everything that a world can have.
fn busy(container: Container, on_touch: OnTouch) -> World {
    let mut random = Random::new(8);
    let mut pair = |low: f32, high: f32| [random.between(low, high), random.between(low, high)];
    let count = 150;
    let positions = (0..count).map(|_| pair(5.0, 45.0)).collect();
    let velocities = (0..count).map(|_| pair(-3.0, 3.0)).collect();
    let radii = (0..count).map(|_| pair(0.2, 0.7)[0]).collect();
    let mut all = Particles::new(positions, velocities, radii, 2.0);
    all.restitution = (0..count).map(|_| pair(0.1, 1.0)[0]).collect();
    (0..count).step_by(9).for_each(|row| all.movable[row] = false);
    for spin in all.spins_mut() {
        [spin.friction, spin.velocity] = pair(0.0, 1.0);
    }
    all.sensors_mut()[7] = true;
    all.kinds = (0..count).map(|row| (row % 3) as u8).collect();
    let settings = WorldSettings {
        gravity: [0.5, 9.0],
        drag: 0.01,
        container,
        sides: Sides([Surface { restitution: Some(0.9), friction: Some(0.2) }; 4]),
        on_touch,
        method: Method::Brute,
        substeps: Some(3),
        sleeping: true,
        track_events: true,
        tree: Settings { leaf_capacity: 7, max_depth: 30, threads: Some(2) },
    };
    forced(all, forces(count as u32), settings)
}

fn containers() -> [Container; 4] {
    [
        Container::None,
        boxed([0.0; 2], [50.0; 2]),
        Container::Circle { center: [25.0; 2], radius: 31.0 },
        Container::Torus { size: [50.0, 60.0] },
    ]
}

#[test]
fn every_scene_goes_on_to_the_bit() {
    for scene in &SCENES {
        let mut world = scene.create(Some(scene.default_count.min(200)), 0).expect("valid");
        for before in [0, 60] {
            run(&mut world, before);
            let mut again = restored(&world);
            assert_same(&world, &again, scene.name);
            let mut on = restored(&world);
            run(&mut on, 15);
            run(&mut again, 15);
            run(&mut world, 15);
            assert_same(&world, &again, scene.name);
            assert_same(&world, &on, scene.name);
            assert_eq!([again.stats(), on.stats()], [world.stats(); 2], "{}", scene.name);
        }
    }
}

#[test]
fn everything_that_a_world_can_have_goes_on_to_the_bit() {
    for on_touch in [OnTouch::Bounce, OnTouch::Merge, OnTouch::Ignore] {
        for container in containers() {
            let name = format!("{on_touch:?} in {container:?}");
            let mut world = busy(container, on_touch);
            run(&mut world, 40);
            let mut again = restored(&world);
            assert_same(&world, &again, &name);
            // Its resting contacts are kept while particles come and go.
            for world in [&mut world, &mut again] {
                let ids = world.bodies().ids().unwrap();
                world.remove(&[ids[3], ids[0], ids[5]]).expect("they are there");
                let more = still(&[[25.0; 2]], 0.5);
                world.add(more).expect("valid");
                run(world, 40);
            }
            assert_same(&world, &again, &name);
            assert_eq!(again.stats(), world.stats(), "{name}");
        }
    }
}

#[test]
fn a_world_without_particles_is_one_too() {
    assert_same(&World::default(), &restored(&World::default()), "nothing");
}

#[test]
fn a_text_is_kept_and_changes_nothing_else() {
    let mut world = busy(Container::None, OnTouch::Bounce);
    let hash = world.state_hash().unwrap();
    for text in [Some(""), Some("{\"view\": [1, 2.5], \"name\": \"µ\"}"), None] {
        world.set_attachment(text.map(str::to_owned));
        let mut again = restored(&world);
        assert_eq!((again.attachment(), again.state_hash().unwrap()), (text, hash));
        run(&mut again, 1);
        assert_eq!(again.attachment(), text);
    }
}

#[test]
fn a_text_that_is_not_utf_8_is_refused() {
    let mut world = World::default();
    world.set_attachment(Some("µ".to_owned()));
    let mut bytes = world.snapshot().unwrap();
    let at = bytes.len() - 1;
    bytes[at] = b'!';
    assert_eq!(refusal(&forged(bytes)), "data is a damaged snapshot; a text in it is not UTF-8");
}

#[test]
fn the_same_world_gives_the_same_bytes_and_few() {
    let mut world = SCENES[1].create(Some(1000), 0).expect("valid");
    run(&mut world, 10);
    assert_eq!(world.snapshot().unwrap(), restored(&world).snapshot().unwrap());
    assert!(world.snapshot().unwrap().len() < 40 * 1000, "{}", world.snapshot().unwrap().len());
}

fn refusal(bytes: &[u8]) -> String {
    World::restore(bytes).expect_err("these are no snapshot").to_string()
}

#[test]
fn foreign_bytes_are_refused_in_a_sentence() {
    let good = busy(Container::None, OnTouch::Bounce).snapshot().unwrap();
    assert_eq!(
        refusal(b"not mine"),
        "data is 8 bytes of something else; it does not begin as a snapshot does"
    );
    assert_eq!(refusal(b""), "data is nothing; a snapshot has at least its head");
    let (mut newer, version) = (good.clone(), good[8]);
    newer[8] = 99;
    assert_eq!(
        refusal(&newer),
        format!("data is a snapshot in format 99; this version of jostle reads format {version}")
    );
    let (there, whole) = (good.len() - 1, good.len());
    assert_eq!(
        refusal(&good[..there]),
        format!(
            "data is a damaged snapshot; it is cut off: {there} of at least {whole} bytes are there"
        )
    );
    let longer = [&good[..], &[0]].concat();
    assert_eq!(refusal(&longer), "data is a damaged snapshot; its checksum is wrong");
}

/// Bytes as somebody would have to forge them to get past the checksum.
fn forged(mut bytes: Vec<u8>) -> Vec<u8> {
    if let Some(body) = bytes.get(HEAD..) {
        let head = [body.len() as u64, checksum(body)].map(u64::to_le_bytes).concat();
        bytes[12..HEAD].copy_from_slice(&head);
    }
    bytes
}

static SMALL: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut random = Random::new(1);
    let mut pair = || [random.between(0.0, 9.0), random.between(0.0, 9.0)];
    let mut all =
        Particles::new((0..40).map(|_| pair()).collect(), vec![[0.0; 2]; 40], vec![0.5; 40], 1.0);
    all.movable[3] = false;
    let container = boxed([0.0; 2], [10.0; 2]);
    let gravity = [0.0, 5.0];
    let track_events = true;
    let settings = WorldSettings { container, gravity, track_events, ..WorldSettings::default() };
    let mut world = forced(all, forces(40), settings);
    world.remove(&[5, 23]).expect("they are there");
    let surface = Surface { restitution: Some(0.5), friction: Some(0.3) };
    let slope = Wall { surface, ..Wall::new([[0.0, 6.0], [7.0, 8.0]]) };
    world.set_walls(vec![slope, Wall::new([[3.0, 1.0], [3.0, 5.0]])]).expect("valid");
    run(&mut world, 30);
    assert!(
        world.wall_contacts().unwrap().iter().any(|contact| contact.wall >= 0),
        "walls push discs"
    );
    world.snapshot().unwrap()
});

proptest! {
    #![proptest_config(crate::common::cases(800))]

    #[test]
    fn a_changed_byte_is_noticed(at in any::<prop::sample::Index>(), by in 1u8..) {
        let mut bytes = SMALL.clone();
        let at = at.index(bytes.len());
        bytes[at] ^= by;
        prop_assert!(World::restore(&bytes).is_err());
    }

    #[test]
    fn what_is_cut_off_is_noticed(at in any::<prop::sample::Index>()) {
        let bytes = &*SMALL;
        let short = &bytes[..at.index(bytes.len())];
        prop_assert!(World::restore(short).is_err());
        prop_assert!(short.len() < HEAD || World::restore(&forged(short.to_vec())).is_err());
    }

    #[test]
    fn forged_bytes_make_a_world_or_a_sentence(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut bytes = SMALL.clone();
        for (at, value) in changes {
            let at = at.index(bytes.len() - HEAD) + HEAD;
            bytes[at] = value;
        }
        // Never a panic, and what is accepted is in order.
        if let Ok(mut world) = World::restore(&forged(bytes)) {
            let mut settings = *world.settings();
            settings.tree.threads = Some(1);
            settings.substeps = settings.substeps.map(|asked| asked.min(4)); // it may be 2³²
            prop_assert!(world.configure(settings).is_ok());
            prop_assert!(world.contacts().is_ok());
            prop_assert!(world.bodies().rows_of(&world.bodies().ids().unwrap()).is_ok());
            let more = still(&[[1.0; 2]], 0.1);
            if let Ok(added) = world.add(more) {
                prop_assert!(world.bodies().contains(added.start));
            }
            let _ = world.step(1e-3, 1);
            let first: Vec<_> = world.bodies().ids().unwrap().into_iter().take(1).collect();
            prop_assert!(world.remove(&first).is_ok());
        }
    }
}
