//! Scene: a Galton board.

use super::placing::{Area, immovable};
use super::random::Random;
use super::scene::checked;
use super::start::{Start, area_of, boxed};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::particles::Particles;
use jostle_world::world::WorldSettings;

/// Default number of balls.
pub(crate) const DEFAULT_COUNT: usize = 300;

/// Distance between pegs of a row, and between rows.
const PITCH: f32 = 32.0;
const ROW: f32 = 28.0;

/// Gap between two pegs, in radii of a ball: two balls cannot block it.
const GAP: f32 = 4.8;

/// Radius of the largest balls.
const BALL: f32 = 4.5;

/// Minimum and maximum number of rows of pegs.
const ROWS: [usize; 2] = [4, 40];

/// Fraction of the area of a bin that resting balls cover.
const PACKED: f32 = 0.82;

/// Gravity, drag, and the terminal velocity. With more drag a ball falls straight from one peg onto
/// the inner side of the next and turns back; with less it keeps its direction. With these values
/// consecutive deflections are nearly independent.
const GRAVITY: f32 = 1600.0;
const DRAG: f32 = 7.0;
const FALL: f32 = GRAVITY / DRAG;

/// Distance between balls in the column above the first peg, in radii.
const COLUMN_STEP: f32 = 8.0;

/// Half width of the outlet of the funnel, in radii of a ball, and the y of its top.
const SPOUT: f32 = 1.8;
const FUNNEL_TOP: f32 = -4.0 * ROW;

/// The geometry of the board in the scene `galton`.
#[derive(Clone, Debug, PartialEq)]
pub struct GaltonBoard {
    /// Number of rows of pegs, that is of deflections of a ball.
    pub rows: usize,
    /// x of the edges of the bins, one more than the number of bins.
    pub bin_edges: Vec<f32>,
    /// y of the top of the bins.
    pub bin_top: f32,
    /// y of the bottom of the bins.
    pub floor: f32,
    /// Radius of the balls.
    pub ball_radius: f32,
}

/// The board for `n` balls (`None`: the default number).
pub fn galton_board(n: Option<usize>) -> Result<GaltonBoard> {
    Ok(board(checked(n.unwrap_or(DEFAULT_COUNT))?))
}

fn board(n: usize) -> GaltonBoard {
    // The number of rows is proportional to n^(2/3), so that the bins have the height of the board.
    // In integers: a power of 2/3 by the mathematical library could round differently, and change
    // the number of rows.
    let enough = |rows: &usize| 160 * rows.pow(3) as u64 >= (n as u64).pow(2);
    let rows = (ROWS[0]..ROWS[1]).find(enough).unwrap_or(ROWS[1]);
    let bin_top = rows as f32 * ROW;
    // The fullest bin gets a fraction of about √(2 / (π · rows)) of the balls.
    let share = (2.0 / (std::f32::consts::PI * rows as f32)).sqrt();
    let height = |ball: f32| n as f32 * share * area_of(ball) / (PACKED * PITCH);
    // With the largest number of rows the bins would become higher than the board. Smaller balls
    // keep its proportions.
    let shrink = (0.7 * bin_top / height(BALL).max(1e-3)).sqrt().min(1.0);
    let ball_radius = BALL * shrink;
    let floor = bin_top + 1.3 * height(ball_radius) + 2.0 * ROW;
    let half = (rows as f32 + 1.0) / 2.0;
    let bin_edges = (0..rows + 2).map(|k| (k as f32 - half) * PITCH).collect();
    GaltonBoard { rows, bin_edges, bin_top, floor, ball_radius }
}

pub(crate) fn galton_view(n: usize) -> Area {
    let board = board(n);
    let half_width = (board.rows as f32 + 1.0) / 2.0 * PITCH;
    [-half_width, FUNNEL_TOP, half_width, board.floor]
}

/// The pegs, then `n` balls.
pub(crate) fn galton(n: usize, random: &mut Random) -> Result<Start> {
    let board = board(n);
    let [min_x, min_y, max_x, floor] = galton_view(n);
    let mut particles = immovable(pegs(board.rows), (PITCH - GAP * board.ball_radius) / 2.0)?;
    let inner = &board.bin_edges[1..=board.rows];
    let bins = inner.iter().map(|&x| [[x, board.bin_top], [x, floor]]);
    let radius = board.ball_radius;
    let funnel = [-1.0, 1.0].map(|side| {
        let spout = side * SPOUT * radius;
        [[spout, -1.5 * ROW], [spout, -2.0 * ROW], [side * 2.5 * PITCH, FUNNEL_TOP]]
    });
    let step = COLUMN_STEP * radius;
    let deviation = 0.5 * radius;
    let places: Vec<[f32; 2]> = (0..n)
        .map(|k| [random.between(-deviation, deviation), -2.0 * ROW - k as f32 * step])
        .collect();
    let top = places.last().map_or(min_y, |last| last[1].min(min_y)) - 2.0 * radius;
    particles.try_extend(&Particles::try_new(
        places,
        memory::filled(n, [0.0, FALL])?,
        memory::filled(n, radius)?,
        1.0,
    )?)?;
    let settings =
        WorldSettings { gravity: [0.0, GRAVITY], drag: DRAG, ..boxed([min_x, top, max_x, floor]) };
    let start = Start::new(particles, settings).restitution(0.48);
    let start = bins.fold(start, |start, bin| start.walled(&bin));
    Ok(funnel.iter().fold(start, |start, side| start.walled(side)))
}

/// Rows of pegs, each offset by half a distance from the row before; the first row has a peg at x =
/// 0.
fn pegs(rows: usize) -> Vec<[f32; 2]> {
    let row = |row: usize| {
        // Without pegs on the walls.
        let limit = rows as i32;
        let across = (-limit..=limit).filter(move |k| (k + row as i32) % 2 == 0);
        across.map(move |k| [k as f32 * 0.5 * PITCH, row as f32 * ROW])
    };
    (0..rows).flat_map(row).collect()
}
