use jostle::*;
#[test]
fn a1() {
    let n = 2;
    let p = Particles::new(vec![[1.15, 0.94], [0.66, 0.22]], vec![[0.0; 2]; n], vec![0.4; n], 1.0);
    let mut w = World::new(p, WorldSettings { restitution: 0.0, ..WorldSettings::default() }).unwrap();
    w.set_walls(vec![Wall { velocity: [30.0, 0.0], ..Wall::new([[0.0, -9.0], [0.0, 9.0]]) }]).unwrap();
    w.step(1.0 / 60.0, 2).unwrap();
    eprintln!("{:?} {:?} {:?}", w.walls(), w.positions(), w.stats());
}
