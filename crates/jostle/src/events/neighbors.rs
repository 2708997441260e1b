//! Which discs each disc may meet during a step, in one array (compressed sparse rows).

use std::collections::HashMap;
use std::ops::Range;

use crate::cache;
use crate::trajectory::Vector;

/// A disc that another one may meet.
#[derive(Clone, Copy, Debug, Default)]
pub struct Neighbor {
    /// Its index.
    pub index: u32,
    /// Which of [`Neighbors::images`] is added to its position.
    pub image: u32,
}

/// Two discs that may meet.
#[derive(Clone, Copy, Debug)]
pub struct NearPair {
    /// Their indices.
    pub pair: [u32; 2],
    /// Offset that is added to the second.
    pub offset: Vector,
    /// Whether they may also meet in later windows of the step.
    pub lasts: bool,
}

/// The neighbours of all discs.
#[derive(Debug, Default)]
pub struct Neighbors {
    /// `all[starts[i]..starts[i + 1]]` are the neighbours of disc i.
    starts: Vec<u32>,
    all: Vec<Neighbor>,
    /// Neighbours found after discs have left their bounds, sorted by disc.
    later: Vec<(u32, Neighbor)>,
    /// Those of them that are neighbours in later windows too.
    lasting: Vec<(u32, Neighbor)>,
    /// Whether a disc has any of these.
    has_later: Vec<bool>,
    /// The number of the image of each list of candidate pairs.
    codes: Vec<u32>,
    images: Images,
}

/// Offsets between a torus and its images, by number.
#[derive(Debug, Default)]
struct Images {
    /// The first two are 0; image k and k ^ 1 are opposite.
    offsets: Vec<Vector>,
    /// The number of each offset, by its bits.
    numbers: HashMap<[u64; 2], u32>,
}

impl Images {
    fn clear(&mut self) {
        self.offsets.clear();
        self.numbers.clear();
        self.offsets.extend([[0.0; 2]; 2]);
    }

    /// The number of an offset; new ones are added together with their opposites.
    fn number(&mut self, offset: Vector) -> u32 {
        if offset == [0.0; 2] {
            return 0;
        }
        // 0 + v, so that no offset is −0.
        let bits = |offset: Vector| offset.map(|v| (0.0 + v).to_bits());
        if let Some(&number) = self.numbers.get(&bits(offset)) {
            return number;
        }
        let number = self.offsets.len() as u32;
        for (number, offset) in [(number, offset), (number + 1, offset.map(|v| -v))] {
            self.offsets.push(offset);
            self.numbers.insert(bits(offset), number);
        }
        number
    }
}

impl Neighbors {
    /// Takes the candidate pairs, a list for each image: the first of a pair, moved by minus the
    /// image, is near the second.
    pub fn fill(&mut self, len: usize, lists: &[([f32; 2], Vec<[u32; 2]>)]) {
        let Self { starts, all, later, lasting, has_later, codes, images } = self;
        codes.clear();
        later.clear();
        lasting.clear();
        has_later.clear();
        images.clear();
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
            let code = images.number(image.map(f64::from));
            codes.push(code);
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

    /// The neighbours of all discs that were found after discs have left their bounds.
    pub fn later(&self) -> &[(u32, Neighbor)] {
        &self.later
    }

    /// Loads the neighbours of a range of discs into the cache.
    pub fn load(&self, range: &Range<u32>) {
        let [first, end] = [range.start, range.end].map(|index| self.starts[index as usize]);
        cache::load(&self.all[first as usize..end as usize]);
    }

    /// The number of the image of each list of candidate pairs.
    pub fn codes(&self) -> &[u32] {
        &self.codes
    }

    /// The offset that is added to the position of a neighbour.
    #[inline(always)]
    pub fn image(&self, neighbor: &Neighbor) -> Vector {
        self.image_of(neighbor.image)
    }

    /// The offset with a number.
    #[inline(always)]
    pub fn image_of(&self, code: u32) -> Vector {
        self.images.offsets[code as usize]
    }

    /// Adds pairs. Lists those that are new, with the numbers of their images.
    pub fn add(&mut self, pairs: &[NearPair], new: &mut Vec<(u32, Neighbor)>) {
        let key = |&(of, found): &(u32, Neighbor)| (of, found.index, found.image);
        new.clear();
        for &NearPair { pair: [a, b], offset, lasts } in pairs {
            let image = self.images.number(offset);
            let both = [
                (a, Neighbor { index: b, image }),
                (b, Neighbor { index: a, image: opposite(image) }),
            ];
            new.push(both[usize::from(b < a)]);
            if lasts && !self.is_near_at_start(&both[0]) {
                self.lasting.extend(both);
            }
        }
        new.sort_unstable_by_key(key);
        new.dedup_by_key(|pair| key(pair));
        new.retain(|pair| {
            let is_later = self.later.binary_search_by_key(&key(pair), key).is_ok();
            !is_later && !self.is_near_at_start(pair)
        });
        for &(a, Neighbor { index: b, image }) in new.iter() {
            self.later.push((a, Neighbor { index: b, image }));
            self.later.push((b, Neighbor { index: a, image: opposite(image) }));
        }
        self.later.sort_unstable_by_key(key);
        self.has_later.resize(self.starts.len() - 2, false);
        new.iter().flat_map(|&(a, found)| [a, found.index]).for_each(|of| {
            self.has_later[of as usize] = true;
        });
    }

    /// Forgets the neighbours that were added for the window before.
    pub fn begin_window(&mut self) {
        let Self { later, lasting, has_later, .. } = self;
        if later.is_empty() {
            return;
        }
        let key = |&(of, found): &(u32, Neighbor)| (of, found.index, found.image);
        lasting.sort_unstable_by_key(key);
        lasting.dedup_by_key(|pair| key(pair));
        later.clone_from(lasting);
        has_later.fill(false);
        later.iter().for_each(|&(of, _)| has_later[of as usize] = true);
    }

    /// Whether a pair was one of the candidate pairs.
    fn is_near_at_start(&self, &(a, Neighbor { index: b, image }): &(u32, Neighbor)) -> bool {
        let near = |of: u32| {
            &self.all[self.starts[of as usize] as usize..self.starts[of as usize + 1] as usize]
        };
        let has = |of: u32, index, image| {
            near(of).iter().any(|found| found.index == index && found.image == image)
        };
        // One large particle may be near very many.
        if near(a).len() <= near(b).len() { has(a, b, image) } else { has(b, a, opposite(image)) }
    }
}

/// The number of the opposite image.
pub fn opposite(code: u32) -> u32 {
    if code < 2 { 0 } else { code ^ 1 }
}
