//! From the order of the shapes to the nodes of the tree.

use super::order::{GRID_LEVELS, Order};
use super::{Node, Quadtree};
use crate::geometry::{Cover, Scalar};
use crate::settings::Settings;

/// A node whose children are still to be found.
struct Open {
    node: usize,
    /// Which entry of `Order::keyed` tells its shapes apart.
    keyed: usize,
    /// Subdivisions of that entry's grid above the node.
    level: u32,
}

/// A child found by a split.
struct Part {
    end: usize,
    keyed: usize,
    level: u32,
}

/// Fills `nodes` from the order, parents before children, siblings adjacent.
pub fn nodes(order: &Order, settings: &Settings, nodes: &mut Vec<Node>) {
    nodes.clear();
    let Some(root) = order.keyed.first() else { return };
    let cell = root.grid.cell(root.keys[0], 0);
    nodes.push(Node {
        start: 0,
        end: root.end as u32,
        children: 0,
        child_count: 0,
        depth: 0,
        cell,
    });
    let mut open = vec![Open { node: 0, keyed: 0, level: 0 }];
    while let Some(next) = open.pop() {
        let node = nodes[next.node];
        if node.len() <= settings.leaf_capacity || usize::from(node.depth) >= settings.max_depth {
            continue;
        }
        let (parts, cell) = split(order, &node, &next);
        let children = nodes.len();
        nodes[next.node].children = children as u32;
        nodes[next.node].child_count = parts.len() as u8;
        nodes[next.node].cell = cell;
        let mut start = node.start;
        for part in parts {
            let keyed = &order.keyed[part.keyed];
            let own = keyed.grid.cell(keyed.keys[start as usize - keyed.start], part.level);
            let cell = common(own, cell);
            open.push(Open { node: nodes.len(), keyed: part.keyed, level: part.level });
            let end = part.end as u32;
            nodes.push(Node {
                start,
                end,
                children: 0,
                child_count: 0,
                depth: node.depth + 1,
                cell,
            });
            start = end;
        }
    }
}

/// The non-empty quarters of a node, and its cell shrunk to just hold them.
fn split(order: &Order, node: &Node, open: &Open) -> (Vec<Part>, [f64; 4]) {
    let (start, end) = (node.start as usize, node.end as usize);
    let keyed = &order.keyed[open.keyed];
    let keys = &keyed.keys[start - keyed.start..end - keyed.start];
    let differing = keys[0] ^ keys[keys.len() - 1];
    if differing == 0 {
        return match order.finer(start, end) {
            Some(finer) => split(order, node, &Open { node: open.node, keyed: finer, level: 0 }),
            None => (by_rank(start, end, open), node.cell),
        };
    }
    // The level at which the first and the last key part: sorted, so all agree above.
    let level = differing.leading_zeros() / 2;
    let shift = 2 * (GRID_LEVELS - 1 - level);
    let mut parts = Vec::with_capacity(4);
    let mut from = 0;
    while from < keys.len() {
        let quarter = keys[from] >> shift;
        from += keys[from..].partition_point(|&key| key >> shift == quarter);
        parts.push(Part { end: start + from, keyed: open.keyed, level: level + 1 });
    }
    (parts, common(keyed.grid.cell(keys[0], level), node.cell))
}

/// Quarters by place, for shapes that no grid can tell apart.
fn by_rank(start: usize, end: usize, open: &Open) -> Vec<Part> {
    let len = end - start;
    let mut parts: Vec<Part> = (1..=4)
        .map(|quarter| start + len * quarter / 4)
        .map(|end| Part { end, keyed: open.keyed, level: open.level })
        .collect();
    parts.dedup_by_key(|part| part.end);
    parts.retain(|part| part.end > start);
    parts
}

/// What two cells have in common.
fn common(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].min(b[3])]
}

/// Fills in the covers, children before parents, and lets each cell hold its
/// centres: in a world 1e30 wide, keys round a centre across its cell's border.
pub fn covers<T: Scalar>(tree: &mut Quadtree<T>) {
    let Quadtree { columns, nodes, covers, .. } = tree;
    covers.clear();
    let Some(&root) = nodes.first() else { return };
    let nothing = Cover::of(&columns.shape(root.start as usize));
    covers.resize(nodes.len(), nothing);
    for index in (0..nodes.len()).rev() {
        let node = &nodes[index];
        let cover = if node.is_leaf() {
            let shapes = node.range().map(|place| Cover::of(&columns.shape(place)));
            shapes.reduce(Cover::join).unwrap_or(nothing)
        } else {
            let children = node.children().map(|child| covers[child]);
            children.reduce(Cover::join).unwrap_or(nothing)
        };
        let ([left, top], [right, bottom]) = (cover.min.map(T::to_f64), cover.max.map(T::to_f64));
        let cell = &mut nodes[index].cell;
        *cell = [cell[0].min(left), cell[1].min(top), cell[2].max(right), cell[3].max(bottom)];
        covers[index] = cover;
    }
}
