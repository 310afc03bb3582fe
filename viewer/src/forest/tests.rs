//! Forests against the simulation that they show, and pictures against pictures.

use super::chains::Chains;
use super::{By, ForestPicture, of_levels};
use crate::gpu::{Gpu, adapters, name};
use crate::offscreen::{Picture as _, Shot};
use crate::target::{Size, Target};
use crate::testing;
use honami_mechanics::{Details, Following, Forest, Pose, Threads};
use honami_scene::forest::live::{self, Begun};
use honami_scene::sky::SUN;
use honami_scene::{ForestScene, Orbit};

const SIZE: Size = Size { width: 320, height: 180, samples: 4 };

fn drawn(gpu: &Gpu, scene: &ForestScene, by: By, time: f64) -> Vec<[u8; 3]> {
    let mut picture = ForestPicture::new(gpu, scene.clone(), by).unwrap();
    let target = Target::new(gpu, SIZE).unwrap();
    let shot = Shot { time, camera: picture.orbit().camera() };
    picture.draw(gpu, &target, &shot).unwrap();
    target.read(gpu).unwrap()
}

/// Of one tree from near and of several, on every adapter there is; and neither without its leaves nor a little aside.
#[test]
fn a_forest_looks_as_it_did() {
    if testing::gpu().is_none() {
        return;
    }
    let many = ForestScene { run_in: 1.0, ..testing::forest(250, 6, 12) };
    let one = ForestScene { run_in: 1.0, ..testing::forest(600, 6, 1) };
    for info in adapters() {
        let gpu = Gpu::open(Some(&name(&info))).unwrap();
        for (name, scene) in [("forest", &many), ("tree", &one)] {
            let pixels = drawn(&gpu, scene, By::Processor, 0.2);
            let truth = testing::truth(name, &pixels, SIZE.width);
            let unlike = testing::unlike(&pixels, &truth);
            assert!(testing::is_alike(&pixels, &truth), "{name} on {}: {unlike} of it", gpu.name());
            let mut bare = scene.clone();
            bare.body.levels.iter_mut().for_each(|level| level.leaves.clear());
            let mut aside = scene.clone();
            aside.places.iter_mut().for_each(|at| at[0] += 0.15);
            for wrong in [bare, aside] {
                let pixels = drawn(&gpu, &wrong, By::Processor, 0.2);
                let unlike = testing::unlike(&pixels, &truth);
                assert!(!testing::is_alike(&pixels, &truth), "{name} on {}: {unlike} of it", gpu.name());
            }
        }
    }
}

/// Whoever moves it, and in however many pictures it came to be where it is.
#[test]
fn the_same_moment_is_the_same_picture() {
    let Some(gpu) = testing::gpu() else { return };
    let scene = testing::forest(150, 5, 6);
    for by in [By::Processor, By::Card] {
        let once = drawn(&gpu, &scene, by, 0.4);
        assert!(once == drawn(&gpu, &scene, by, 0.4), "{by:?}: to the byte");
        let mut picture = ForestPicture::new(&gpu, scene.clone(), by).unwrap();
        let (target, camera) = (Target::new(&gpu, SIZE).unwrap(), picture.orbit().camera());
        let mut at = |time| {
            picture.draw(&gpu, &target, &Shot { time, camera }).unwrap();
            target.read(&gpu).unwrap()
        };
        assert!(at(0.2) != once, "{by:?}: it moves");
        assert!(at(0.4) == once, "{by:?}: in two");
        assert!(at(0.9) != once && at(0.4) == once, "{by:?}: back");
    }
    let [host, card] = [By::Processor, By::Card].map(|by| drawn(&gpu, &scene, by, 0.4));
    assert!(testing::is_alike(&host, &card));
}

/// A squall that comes from 60 m away by 10 m/s: with what is shown, when it is typed, and as it is turned; by both the same.
#[test]
fn winds_begin_at_the_same_time_whoever_moves_the_forest() {
    let Some(gpu) = testing::gpu() else { return };
    let scene = ForestScene { wind: "squall".to_owned(), ..testing::forest(60, 4, 2) };
    let squall = |words: &str| live::wind(&scene, words, 0).unwrap();
    let here = |speed: f64, seconds: f64| speed * (-((60.0 - 10.0 * seconds) / 30.0).powi(2)).exp();
    for by in [By::Processor, By::Card] {
        let mut picture = ForestPicture::new(&gpu, scene.clone(), by).unwrap();
        let felt = |picture: &mut ForestPicture, time| {
            picture.go_on(&gpu, time).unwrap();
            picture.mover.blowing(0).norm()
        };
        for (time, seconds) in [(0.0, 0.0), (6.0, 6.0), (9.0, 9.0)] {
            let felt = felt(&mut picture, time);
            assert!((felt - here(15.0, seconds)).abs() < 1e-6, "{by:?} {time} s: {felt}");
        }
        picture.begin(squall("squall"));
        for (time, seconds) in [(9.0, 0.0), (14.0, 5.0)] {
            let felt = felt(&mut picture, time);
            assert!((felt - here(15.0, seconds)).abs() < 1e-6, "{by:?} {time} s: {felt}");
        }
        picture.turn(squall("squall:speed=30"));
        let felt = felt(&mut picture, 15.0);
        assert!((felt - here(30.0, 6.0)).abs() < 1e-6, "{by:?}: {felt}");
    }
}

/// Far away it comes step by step, and back in the wind that blows by then.
#[test]
fn jumps_take_so_many_steps_at_a_time() {
    let Some(gpu) = testing::gpu() else { return };
    let scene = ForestScene { wind: "still".to_owned(), ..testing::forest(60, 4, 2) };
    let step = scene.pace.step;
    for by in [By::Processor, By::Card] {
        let mut picture = ForestPicture::new(&gpu, scene.clone(), by).unwrap();
        picture.go_towards(&gpu, 1e9, 32).unwrap();
        assert!(!picture.is_at(1e9) && (picture.time() - 32.0 * step).abs() < 1e-9, "{by:?}");
        picture.begin(live::wind(&scene, "steady:speed=7", 0).unwrap());
        picture.go_towards(&gpu, 0.2, 32).unwrap();
        assert!((picture.time() + scene.run_in - 32.0 * step).abs() < 1e-9, "{by:?}: {}", picture.time());
        let mut n = 1;
        while !picture.is_at(0.2) {
            picture.go_towards(&gpu, 0.2, 32).unwrap();
            n += 1;
        }
        assert_eq!(n, 4, "{by:?}: 110 steps");
        assert!((picture.mover.blowing(0).norm() - 7.0).abs() < 1e-9, "{by:?}");
    }
}

/// Each node but the root in one chain, behind the one that bears it, or at its head behind one of a lower rank.
#[test]
fn chains_hold_every_node_behind_what_bears_it() {
    for n in [2, 3, 40, 700] {
        let scene = testing::forest(n, 1, 1);
        let Following::Turns(turning) = scene.stirring.following() else { unreachable!() };
        let order = &scene.body.order;
        let Chains { chains, nodes, ranks } = Chains::new(turning, order);
        let mut rank_of = vec![None; n];
        rank_of[0] = Some(0);
        for (rank, ends) in (1..).zip(ranks.windows(2)) {
            for [first, n, bearer] in &chains[ends[0] as usize..ends[1] as usize] {
                let mut before = *bearer;
                assert!(rank_of[before as usize].is_some_and(|of| of < rank));
                for row in &nodes[*first as usize..(first + n) as usize] {
                    assert!(*row > before && rank_of[*row as usize].replace(rank).is_none());
                    let bears = turning.parents()[order[*row as usize] as usize - 1];
                    assert_eq!(order[before as usize], bears);
                    before = *row;
                }
            }
        }
        assert!(rank_of.iter().all(Option::is_some), "{n} nodes");
        assert!(ranks.len() <= 2 + n.ilog2() as usize, "{n} nodes: {ranks:?}");
    }
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks().0.iter().map(|four| f32::from_le_bytes(*four)).collect()
}

fn numbers(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks().0.iter().map(|four| u32::from_le_bytes(*four)).collect()
}

/// In a storm over hundreds of steps: copies near and far, some out of the picture, of several sizes and masses.
#[test]
fn a_card_has_every_node_where_the_simulation_has_it() {
    let Some(gpu) = testing::gpu() else { return };
    let scene = testing::forest(300, 8, 40);
    let grove = scene.grove();
    let threads = Threads::new(1).unwrap();
    let wind = Begun::new(live::wind(&scene, &scene.wind, 0).unwrap(), scene.run_in);
    let mut forest = Forest::new(&scene.stirring, &scene.body.order, &scene.stands, &scene.pace).unwrap();
    let mut picture = ForestPicture::new(&gpu, scene.clone(), By::Card).unwrap();
    let target = Target::new(&gpu, Size { width: 1280, height: 720, samples: 1 }).unwrap();
    let orbit = picture.orbit();
    let sharper = live::sharper(of_levels(&gpu, &target)[1]);
    let farther = scene.body.levels.iter().skip(1).map(|level| (level.from * sharper, level.detail()));
    let details = Details::new(&farther.collect::<Vec<_>>()).unwrap();
    let (mut n_of_levels, mut farthest) = (vec![0; scene.body.levels.len()], 0.0_f32);
    for (time, times) in [(0.0, 0.6), (3.0, 1.5), (8.0, 6.0)] {
        let camera = Orbit { distance: orbit.distance * times, ..orbit }.camera();
        picture.draw(&gpu, &target, &Shot { time, camera }).unwrap();
        while forest.time() < scene.run_in + time - 1e-6 {
            let now = forest.time();
            forest.step(&|copy| grove.blowing(&wind, copy, now), None, &threads).unwrap();
        }
        let view = live::view(&camera, 16.0 / 9.0);
        let level = |copy: usize| {
            details.level(&scene.stirring, &view, &grove.places[copy], grove.stands[copy].scale.into())
        };
        let of_copies: Vec<_> = (0..scene.places.len())
            .map(|copy| level(copy).map_or_else(Default::default, |level| scene.body.levels[level].detail()))
            .collect();
        let n_rows = of_copies.iter().map(|detail| detail.n_nodes as usize).sum();
        let mut wanted = vec![[0.0; 3]; n_rows];
        forest.pose(Pose { details: Some(&of_copies), motion: &mut wanted }, &threads);

        let moved = floats(&gpu.read(&picture.stage.moved).unwrap());
        let moved = moved.as_chunks::<3>().0;
        let firsts = numbers(&gpu.read(&picture.stage.firsts).unwrap());
        let seen = numbers(&gpu.read(&picture.stage.seen).unwrap());
        let calls = numbers(&gpu.read(&picture.stage.calls).unwrap());
        let mut begin = 0;
        for (copy, detail) in of_copies.iter().enumerate() {
            let n = detail.n_nodes as usize;
            for (wanted, came) in wanted[begin..begin + n].iter().zip(&moved[firsts[copy] as usize..]) {
                farthest = wanted.iter().fold(farthest, |far, v| far.max(v.abs()));
                assert!(
                    (0..3).all(|axis| (wanted[axis] - came[axis]).abs() < 1e-4),
                    "{time} {copy}: {wanted:?} {came:?}"
                );
            }
            begin += n;
        }
        for (k, n_of_level) in n_of_levels.iter_mut().enumerate() {
            let list: Vec<u32> = (0..scene.places.len())
                .filter(|copy| level(*copy) == Some(k))
                .map(|copy| copy as u32)
                .collect();
            let came = &seen[k * scene.places.len()..][..calls[10 * k + 1] as usize];
            assert_eq!(came, list, "level {k}");
            assert_eq!(calls[10 * k + 1], calls[10 * k + 6]);
            *n_of_level += list.len();
        }
    }
    assert!(farthest > 0.5, "a storm: {farthest} m");
    assert!(n_of_levels.iter().all(|n| *n > 0), "{n_of_levels:?}");
}

/// Of small ones an error with the numbers, by what is seen at once: none of the copies is left out in silence.
#[test]
fn what_an_adapter_has_no_room_for_is_said() {
    if testing::gpu().is_none() {
        return;
    }
    let scene = ForestScene { run_in: 0.0, ..testing::forest(120, 4, 600) };
    let n_bytes = 12 * 600 * scene.body.levels[0].n_nodes as usize;
    let drawn = |bytes: usize, by, angle: f32| {
        let gpu = Gpu::small(bytes as u64).unwrap();
        let mut picture = ForestPicture::new(&gpu, scene.clone(), by)?;
        let target = Target::new(&gpu, SIZE).unwrap();
        let orbit = Orbit { angle, ..picture.orbit() };
        picture.draw(&gpu, &target, &Shot { time: 0.0, camera: orbit.camera() })
    };
    let half = n_bytes / 8;
    drawn(half, By::Processor, 0.7).unwrap();
    drawn(half, By::Card, 0.05).unwrap();
    let error = drawn(half, By::Card, 0.7).unwrap_err().to_string();
    assert!(error.contains("copies that are seen at once") && error.contains("--cpu"), "{error}");
    for by in [By::Processor, By::Card] {
        let error = drawn(1024, by, 0.7).unwrap_err().to_string();
        assert!(error.contains("600 copies") && error.contains("fewer copies"), "{error}");
    }
}

/// Seen from above, beside the same ground without any shadow: that of a crown where the sun casts it, and none of a bare
/// plant; of either that of its trunk.
#[test]
fn crowns_cast_shadows_where_they_are_and_trunks_do() {
    let Some(gpu) = testing::gpu() else { return };
    let mut leafy = ForestScene { wind: "still".to_owned(), run_in: 0.0, ..testing::forest(600, 6, 1) };
    leafy.body.levels.iter_mut().flat_map(|level| &mut level.leaves).for_each(|leaf| leaf.length *= 3.0);
    let mut bare = leafy.clone();
    bare.body.levels.iter_mut().for_each(|level| level.leaves.clear());
    let mut none = bare.clone();
    none.body.levels.iter_mut().flat_map(|level| &mut level.rings).for_each(|ring| ring.radius = 0.0);
    let height = leafy.stirring.height() as f32;
    // Where the shadow of a place ends that is a height above the root, and what is across that.
    let fall: [f32; 2] = [0, 1].map(|axis| -height * SUN[axis] / SUN[2]);
    let across = [-fall[1], fall[0]].map(|v| v * height / fall[0].hypot(fall[1]));
    let target = [fall[0] / 2.0, fall[1] / 2.0, 0.0];
    let orbit = Orbit { target, distance: 2.6 * height, azimuth: 2.4, elevation: 1.2, angle: 0.6 };
    let (camera, size) = (orbit.camera(), Size { width: 640, height: 480, samples: 4 });
    // So far along the shadow of the height and so far beside it, both in heights: the mean of a few pixels.
    let light = |pixels: &[[u8; 3]], along: f32, beside: f32| {
        let [x, y] = [0, 1].map(|axis| fall[axis] * along + across[axis] * beside);
        let ([right, up], _) = camera.seen([x, y, 0.0]);
        let (x, y) = ((320.0 + 240.0 * right) as usize, (240.0 - 240.0 * up) as usize);
        let near = (y - 1..y + 2).flat_map(|y| (x - 1..x + 2).map(move |x| y * 640 + x));
        near.map(|k| f32::from(pixels[k][1])).sum::<f32>() / 9.0
    };
    for by in [By::Processor, By::Card] {
        let drawn = |scene: &ForestScene| {
            let mut picture = ForestPicture::new(&gpu, scene.clone(), by).unwrap();
            let target = Target::new(&gpu, size).unwrap();
            picture.draw(&gpu, &target, &Shot { time: 0.0, camera }).unwrap();
            target.read(&gpu).unwrap()
        };
        let [leafy, bare, none] = [&leafy, &bare, &none].map(drawn);
        let left =
            |pixels: &[[u8; 3]], along, beside| light(pixels, along, beside) / light(&none, along, beside);
        // Many places, that no branch decides; on the side where the crown itself is not before it.
        let crown = |pixels: &[[u8; 3]]| {
            let at = |k: usize| left(pixels, 0.62 + 0.02 * (k % 10) as f32, 0.02 * (k / 10) as f32 - 0.1);
            (0..100).map(at).sum::<f32>() / 100.0
        };
        let [of_leaves, of_wood] = [&leafy, &bare].map(|pixels| crown(pixels));
        assert!(of_leaves < 0.75, "{by:?}: under leaves {of_leaves} is left");
        assert!((0.85..0.999).contains(&of_wood), "{by:?}: under branches {of_wood} is left");
        // Trunks are not quite straight: the darkest place across, all along.
        let trunk = |pixels: &[[u8; 3]]| {
            let across = |along: f32| {
                (-6..7).map(|k| left(pixels, along, 0.005 * k as f32)).fold(f32::INFINITY, f32::min)
            };
            [0.06, 0.09, 0.12, 0.15].map(across).iter().fold(0.0_f32, |most, left| most.max(*left))
        };
        let [under_leaves, thin] = [&leafy, &bare].map(|pixels| trunk(pixels));
        assert!(
            thin < 0.85 && under_leaves < 0.85,
            "{by:?}: trunks leave {thin}, with leaves {under_leaves}"
        );
        let open = left(&bare, 0.12, -0.1);
        assert!(open > 0.97, "{by:?}: beside a trunk {open} is left");
    }
}
