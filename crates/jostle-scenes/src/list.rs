//! The list of all scenes.

use super::scene::{Make, Scene};
use super::{
    emitters, falling, fluid, galton, games, gases, heap, life, machines, mixing, pinball, sand,
    soft, stars,
};
use jostle_base::error::{Error, Result};

/// All scenes.
pub const SCENES: [Scene; 24] = [
    Scene {
        name: "article",
        default_count: 500,
        about: "The article's particles in its 800 × 500 window, with jostle's physics. \
                They come to rest, unlike under the article's rules.",
        make: Make::Whole(falling::article),
        view: falling::article_view,
    },
    Scene {
        name: "gas",
        default_count: 10_000,
        about: "Equal elastic discs over 40 % of the area. \
                The distribution of speeds becomes that of a gas in equilibrium; energy is conserved.",
        make: Make::Parts(gases::gas),
        view: gases::gas_view,
    },
    Scene {
        name: "pile",
        default_count: 1_000,
        about: "Discs of radius 5 to 10 fall into a box and come to rest. \
                They hardly overlap, even at the bottom.",
        make: Make::Parts(falling::pile),
        view: falling::pile_view,
    },
    Scene {
        name: "rain",
        default_count: 2_000,
        about: "Drops fall and collect on the ground. \
                The tree is deeper where they are dense.",
        make: Make::Whole(falling::rain),
        view: falling::rain_view,
    },
    Scene {
        name: "mixed",
        default_count: 5_000,
        about: "Radii from 1 to 100, each factor of two with the same area. \
                A uniform grid is slow for such sizes; the tree is not.",
        make: Make::Whole(gases::mixed),
        view: gases::mixed_view,
    },
    Scene {
        name: "clusters",
        default_count: 5_000,
        about: "Nine tenths of the discs start in a hundredth of the area. \
                Nine clusters expand, and the small boxes of the tree follow them.",
        make: Make::Whole(gases::clusters),
        view: gases::clusters_view,
    },
    Scene {
        name: "shots",
        default_count: 1_000,
        about: "Small discs at up to 3,000 px/s among immovable pegs. \
                None passes through a peg or a wall.",
        make: Make::Whole(games::shots),
        view: games::shots_view,
    },
    Scene {
        name: "billiards",
        default_count: 16,
        about: "A cue ball with side spin breaks a rack of balls. \
                Its momentum and its spin spread over all balls.",
        make: Make::Whole(games::billiards),
        view: games::billiards_view,
    },
    Scene {
        name: "orbit",
        default_count: 2_000,
        about: "Discs circle in a round container. \
                The wall has no friction, so the rotation does not stop.",
        make: Make::Whole(games::orbit),
        view: games::orbit_view,
    },
    Scene {
        name: "springs",
        default_count: 800,
        about: "Soft bodies of discs and springs fall beside a hanging cloth and a chain. \
                They deform, oscillate and come to rest in their original shapes.",
        make: Make::Whole(soft::springs),
        view: soft::springs_view,
    },
    Scene {
        name: "stars",
        default_count: 10_000,
        about: "A slowly rotating cloud of dust contracts under its gravitation, and grains that touch merge. \
                Stars form from the centre outwards.",
        make: Make::Whole(stars::stars),
        view: stars::stars_view,
    },
    Scene {
        name: "thermostat",
        default_count: 4_000,
        about: "A hot light gas on the left and a cold heavy one on the right. \
                They mix, and the walls bring both to one speed.",
        make: Make::Parts(mixing::thermostat),
        view: mixing::thermostat_view,
    },
    Scene {
        name: "sand",
        default_count: 2_000,
        about: "Grains run through the neck of an hourglass made of line segments. \
                The flow does not depend on the amount above the neck.",
        make: Make::Whole(sand::sand),
        view: sand::sand_view,
    },
    Scene {
        name: "galton",
        default_count: galton::DEFAULT_COUNT,
        about: "Balls fall through rows of pegs, which deflect them to the left or to the right. \
                Their numbers in the bins follow the binomial distribution.",
        make: Make::Whole(galton::galton),
        view: galton::galton_view,
    },
    Scene {
        name: "brownian",
        default_count: 3_000,
        about: "One large heavy disc starts at rest in a gas of small light ones. \
                Collisions cause its random walk; its mean energy becomes that of a small disc.",
        make: Make::Whole(mixing::brownian),
        view: mixing::brownian_view,
    },
    Scene {
        name: "emitters",
        default_count: emitters::DEFAULT_COUNT,
        about: "Three jets meet above a fountain, and drops run down its steps into the basin. \
                Pumps take drops out of the basin, and let them start again from the nozzles.",
        make: Make::Whole(emitters::fountain),
        view: emitters::view,
    },
    Scene {
        name: "heap",
        default_count: 1_500,
        about: "A column of grains with friction 0.8 collapses on rough ground. \
                The heap keeps a slope; with friction 0 it spreads.",
        make: Make::Whole(heap::heap),
        view: heap::heap_view,
    },
    Scene {
        name: "mill",
        default_count: 1_500,
        about: "A wheel with five paddles turns in a drum and lifts the grains. \
                The paddles are immovable discs that a motor drives.",
        make: Make::Whole(machines::mill),
        view: machines::mill_view,
    },
    Scene {
        name: "conveyor",
        default_count: 600,
        about: "Rollers that turn carry grains with friction up to the right. \
                They fall off the end, and a chute returns them to the first roller.",
        make: Make::Whole(machines::conveyor),
        view: machines::conveyor_view,
    },
    Scene {
        name: "piston",
        default_count: 2_000,
        about: "A piston halves the volume of a gas in eight seconds and restores it in eight. \
                The speeds of the discs almost double and decrease again.",
        make: Make::Whole(machines::piston),
        view: machines::piston_view,
    },
    Scene {
        name: "pinball",
        default_count: 12,
        about: "Balls among bumpers on a table with flippers that move by themselves. \
                No ball passes through a flipper, at any speed.",
        make: Make::Whole(pinball::pinball),
        view: pinball::pinball_view,
    },
    Scene {
        name: "life",
        default_count: 4_000,
        about: "Particle life: six kinds attract and repel each other, not always mutually. \
                Chains of all colours form, crawl, join and break.",
        make: Make::Whole(life::life),
        view: life::life_view,
    },
    Scene {
        name: "flock",
        default_count: 2_000,
        about: "Birds keep apart, fly in the mean direction of their neighbours, and stay near them. \
                Flocks form and meet.",
        make: Make::Whole(life::flock),
        view: life::flock_view,
    },
    Scene {
        name: "fluid",
        default_count: 1_500,
        about: "Two droplets of a Lennard-Jones fluid meet and become one, in their vapour. \
                Energy and momentum are conserved.",
        make: Make::Whole(fluid::fluid),
        view: fluid::fluid_view,
    },
];

/// The scene called `name`.
pub fn find(name: &str) -> Result<&'static Scene> {
    SCENES.iter().find(|scene| scene.name == name).ok_or_else(|| {
        let names = SCENES.map(|scene| scene.name).join(", ");
        Error::of("name", format!("'{name}'"), &format!("the scenes are {names}"))
    })
}
