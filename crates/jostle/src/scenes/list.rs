//! The list of all scenes.

use super::{
    Scene, falling, fountain, galton, games, gases, heap, machines, mixing, pinball, sand, soft,
    stars,
};

/// All scenes.
pub const SCENES: [Scene; 21] = [
    Scene {
        name: "article",
        default_count: 500,
        about: "The article's particles in its 800 × 500 window, under right physics. \
                Watch them come to rest, which the article's rules never let them do.",
        make: falling::article,
        view: falling::article_view,
    },
    Scene {
        name: "gas",
        default_count: 10_000,
        about: "Equal elastic discs over 40 % of the area. \
                Speeds that start out even soon spread as in a real gas, and the energy stays.",
        make: gases::gas,
        view: gases::gas_view,
    },
    Scene {
        name: "pile",
        default_count: 1_000,
        about: "Discs of radius 5 to 10 fall into a box and come to rest. \
                Look how little they overlap, even at the bottom.",
        make: falling::pile,
        view: falling::pile_view,
    },
    Scene {
        name: "rain",
        default_count: 2_000,
        about: "Drops fall in over time and fill the ground. \
                The tree deepens where they gather and stays shallow in the sky.",
        make: falling::rain,
        view: falling::rain_view,
    },
    Scene {
        name: "mixed",
        default_count: 5_000,
        about: "Radii from 1 to 100, every octave covering the same area. \
                One size of grid cell fits none of them; the tree does not mind.",
        make: gases::mixed,
        view: gases::mixed_view,
    },
    Scene {
        name: "clusters",
        default_count: 5_000,
        about: "Nine tenths of the discs start in a hundredth of the area. \
                Watch nine crowds burst and the tree's small boxes spread with them.",
        make: gases::clusters,
        view: gases::clusters_view,
    },
    Scene {
        name: "shots",
        default_count: 1_000,
        about: "Small shots at up to 3,000 px/s among pegs that nothing moves. \
                None ever passes through a peg or a wall.",
        make: games::shots,
        view: games::shots_view,
    },
    Scene {
        name: "billiards",
        default_count: 16,
        about: "A cue ball with side spin breaks a rack of balls. \
                Follow how its momentum and its spin spread over all.",
        make: games::billiards,
        view: games::billiards_view,
    },
    Scene {
        name: "orbit",
        default_count: 2_000,
        about: "Discs swirl about the centre of a round container. \
                The wall has no friction, so the swirl never dies.",
        make: games::orbit,
        view: games::orbit_view,
    },
    Scene {
        name: "springs",
        default_count: 800,
        about: "Soft bodies of discs tied by springs fall beside a hanging cloth and a chain. \
                See how they give way, swing back and come to rest in their old shapes.",
        make: soft::springs,
        view: soft::springs_view,
    },
    Scene {
        name: "stars",
        default_count: 10_000,
        about: "A slowly turning cloud of dust pulls itself together, and grains that touch merge. \
                Watch stars form from the middle outwards and sweep up what is near them.",
        make: stars::stars,
        view: stars::stars_view,
    },
    Scene {
        name: "thermostat",
        default_count: 4_000,
        about: "A hot light gas on the left and a cold heavy one on the right. \
                They mix, while walls that have a temperature bring both to one speed.",
        make: mixing::thermostat,
        view: mixing::thermostat_view,
    },
    Scene {
        name: "sand",
        default_count: 2_000,
        about: "Grains run through the neck of an hourglass made of line segments. \
                They flow evenly, however much is still above them, and heap up below.",
        make: sand::sand,
        view: sand::sand_view,
    },
    Scene {
        name: "galton",
        default_count: 300,
        about: "Balls fall through rows of pegs, at each of them to the left or to the right. \
                The bins below fill to the curve of the binomial distribution.",
        make: galton::galton,
        view: galton::galton_view,
    },
    Scene {
        name: "brownian",
        default_count: 3_000,
        about: "One large heavy disc starts at rest in a gas of small light ones. \
                Unseen blows add up to its random walk, with as much energy as each of theirs.",
        make: mixing::brownian,
        view: mixing::brownian_view,
    },
    Scene {
        name: "emitters",
        default_count: 3_000,
        about: "Three jets meet above a fountain, and their water runs down its steps. \
                The oldest drops go as new ones come, so their number has a cap.",
        make: fountain::emitters,
        view: fountain::emitters_view,
    },
    Scene {
        name: "heap",
        default_count: 1_500,
        about: "A column of grains with friction 0.8 collapses on rough ground. \
                The heap keeps a slope; set friction to 0 and it runs apart.",
        make: heap::heap,
        view: heap::heap_view,
    },
    Scene {
        name: "mill",
        default_count: 1_500,
        about: "A wheel with five paddles turns in a drum and lifts the grains. \
                Nothing slows it down: the paddles are immovable discs that a motor drives.",
        make: machines::mill,
        view: machines::mill_view,
    },
    Scene {
        name: "conveyor",
        default_count: 600,
        about: "Rollers that turn carry grains with friction up to the right. \
                They fall off the end, and a chute leads them back to the first roller.",
        make: machines::conveyor,
        view: machines::conveyor_view,
    },
    Scene {
        name: "piston",
        default_count: 2_000,
        about: "A piston halves the volume of a gas in eight seconds and gives it back in eight. \
                Its energy doubles meanwhile, as it must when two dimensions are compressed slowly.",
        make: machines::piston,
        view: machines::piston_view,
    },
    Scene {
        name: "pinball",
        default_count: 12,
        about: "Balls among bumpers, on a table whose flippers beat by themselves. \
                No ball passes through a flipper, however fast both are.",
        make: pinball::pinball,
        view: pinball::pinball_view,
    },
];
