//! Which discs each disc may meet during a step, in one array (compressed sparse rows).

use std::ops::Range;

use crate::trajectory::Vector;

/// A disc that another one may meet.
#[derive(Clone, Copy, Debug, Default)]
pub struct Neighbor {
    /// Its index.
    pub index: u32,
    /// Which of [`Neighbors::images`] is added to its position.
    pub image: u16,
}

/// The neighbours of all discs.
#[derive(Debug, Default)]
pub struct Neighbors {
    /// `all[starts[i]..starts[i + 1]]` are the neighbours of disc i.
    starts: Vec<u32>,
    all: Vec<Neighbor>,
    /// Neighbours found after discs have left their bounds, sorted by disc.
    later: Vec<(u32, Neighbor)>,
    /// Whether a disc has any of these.
    has_later: Vec<bool>,
    /// Offsets between a torus and its images. The first is 0; image k and k ^ 1 are opposite.
    images: Vec<Vector>,
}

impl Neighbors {
    /// Takes the candidate pairs, a list for each image: the first of a pair, moved by minus the
    /// image, is near the second.
    pub fn fill(&mut self, len: usize, lists: &[([f32; 2], Vec<[u32; 2]>)]) {
        let Self { starts, all, later, has_later, images } = self;
        later.clear();
        has_later.clear();
        images.clear();
        images.extend([[0.0; 2]; 2]);
        starts.clear();
        starts.resize(len + 2, 0);
        for &[a, b] in lists.iter().flat_map(|(_, pairs)| pairs) {
            starts[a as usize + 2] += 1;
            starts[b as usize + 2] += 1;
        }
        for index in 2..starts.len() {
            starts[index] += starts[index - 1];
        }
        all.resize(starts[len + 1] as usize, Neighbor::default());
        for (image, pairs) in lists {
            let code = image_code(images, image.map(f64::from));
            for &[a, b] in pairs {
                let mut put = |at: u32, index, image| {
                    let next = &mut starts[at as usize + 1];
                    all[*next as usize] = Neighbor { index, image };
                    *next += 1;
                };
                put(a, b, code);
                put(b, a, opposite(code));
            }
        }
    }

    /// Calls `act` with each neighbour of a disc.
    #[inline(always)]
    pub fn of(&self, index: u32, mut act: impl FnMut(&Neighbor)) {
        let range = self.starts[index as usize] as usize..self.starts[index as usize + 1] as usize;
        for neighbor in &self.all[range] {
            act(neighbor);
        }
        if self.has_later.get(index as usize).is_some_and(|&has| has) {
            self.later[self.later_of(index)].iter().for_each(|(_, neighbor)| act(neighbor));
        }
    }

    /// Which entries of `later` belong to a disc.
    fn later_of(&self, index: u32) -> Range<usize> {
        let first = self.later.partition_point(|&(of, _)| of < index);
        let len = self.later[first..].iter().take_while(|&&(of, _)| of == index).count();
        first..first + len
    }

    /// The number of neighbours of a range of discs, or more.
    pub fn count(&self, range: &Range<u32>) -> usize {
        let [first, end] = [range.start, range.end].map(|index| self.starts[index as usize]);
        (end - first) as usize + self.later.len() + 1
    }

    /// The offset that is added to the position of a neighbour.
    #[inline(always)]
    pub fn image(&self, neighbor: &Neighbor) -> Vector {
        self.image_of(neighbor.image)
    }

    /// The offset with a number.
    #[inline(always)]
    pub fn image_of(&self, code: u16) -> Vector {
        self.images[usize::from(code)]
    }

    /// Adds pairs: the second, moved by the offset, is near the first. Keeps those in the list that
    /// are new.
    pub fn add(&mut self, pairs: &mut Vec<(u32, u32, Vector)>) {
        pairs.retain(|&(a, b, image)| {
            let mut known = false;
            self.of(a, |found| known |= found.index == b && self.image(found) == image);
            !known
        });
        for &(a, b, image) in pairs.iter() {
            let code = image_code(&mut self.images, image);
            self.later.push((a, Neighbor { index: b, image: code }));
            self.later.push((b, Neighbor { index: a, image: opposite(code) }));
        }
        self.later.sort_unstable_by_key(|(of, found)| (*of, found.index, found.image));
        self.later.dedup_by_key(|(of, found)| (*of, found.index, found.image));
        self.has_later.resize(self.starts.len() - 2, false);
        self.later.iter().for_each(|&(of, _)| self.has_later[of as usize] = true);
    }
}

/// The number of an image; new ones are added together with their opposites.
fn image_code(images: &mut Vec<Vector>, image: Vector) -> u16 {
    // Both the first and its opposite are 0.
    let known = images.iter().position(|&known| known == image);
    let code = known.unwrap_or_else(|| {
        images.extend([image, image.map(|v| -v)]);
        images.len() - 2
    });
    code as u16
}

/// The number of the opposite image.
pub fn opposite(code: u16) -> u16 {
    if code < 2 { 0 } else { code ^ 1 }
}
