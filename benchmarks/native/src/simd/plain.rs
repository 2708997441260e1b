//! Without vector instructions: one neighbour at a time.

use std::ops::Range;

use super::{BOXES, Columns, EQUAL, Kind, Lanes, Output};

/// See the module.
#[derive(Clone, Copy)]
pub struct Plain;

impl Lanes for Plain {
    #[inline(always)]
    fn strip<const KIND: Kind>(
        self,
        columns: &Columns,
        row: usize,
        strip: Range<usize>,
        reach_squared: f32,
        output: Output,
    ) -> Output {
        columns.check(row, &strip, KIND);
        let mut output = output.with_room(strip.len());
        for other in strip {
            if overlaps::<KIND>(columns, row, other, reach_squared) {
                let (i, j) = (columns.id[row], columns.id[other]);
                // SAFETY: there is room for the whole strip, and one more pair is written.
                output = unsafe {
                    *output.next() = [i.min(j), i.max(j)];
                    output.advance(1)
                };
            }
        }
        output
    }
}

fn overlaps<const KIND: Kind>(all: &Columns, i: usize, j: usize, reach_squared: f32) -> bool {
    let (dx, dy) = (all.x[i] - all.x[j], all.y[i] - all.y[j]);
    if KIND == EQUAL {
        return dx * dx + dy * dy < reach_squared;
    }
    if all.size[j] > all.size[i] || all.size[j] == all.size[i] && j <= i {
        return false;
    }
    if KIND == BOXES {
        let [w, h] = &all.half;
        return dx.abs() < w[i] + w[j] && dy.abs() < h[i] + h[j];
    }
    let reach = all.size[i] + all.size[j];
    dx * dx + dy * dy < reach * reach
}
