//! Milliseconds that it takes to put a world into bytes and to restore it:
//! `cargo run --release --package jostle --example snapshot`.

use std::time::Instant;

use jostle_scenes::{self as scenes, STEP};
use jostle_world::World;

fn main() {
    for (scene, count) in [("gas", 10_000), ("pile", 10_000), ("gas", 1_000_000)] {
        let scene = scenes::find(scene).expect("there is such a scene");
        let mut world = scene.create(Some(count), 0).expect("a scene is valid");
        world.step(STEP, 10).expect("a scene can be stepped");
        let mut times: Vec<[f64; 2]> = (0..9).map(|_| times(&world)).collect();
        times.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let bytes = world.snapshot().unwrap().len();
        let [save, restore] = times[times.len() / 2];
        println!(
            "{:5} {count:8}: {bytes:9} bytes, saved in {save:7.3} ms, restored in {restore:7.3} ms",
            scene.name
        );
    }
}

fn times(world: &World) -> [f64; 2] {
    let start = Instant::now();
    let bytes = world.snapshot().unwrap();
    let saved = start.elapsed();
    let again = World::restore(&bytes).expect("a snapshot can be restored");
    let restored = start.elapsed() - saved;
    assert_eq!(again.len(), world.len());
    [saved, restored].map(|time| time.as_secs_f64() * 1e3)
}
