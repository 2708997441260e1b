//! Which discs each disc may meet during a step: an array for each block of discs (compressed sparse
//! rows).

use std::collections::HashMap;
use std::ops::Range;

use crate::trajectory::Vector;
use jostle_base::error::Result;
use jostle_base::{cache, memory, parallel, sorting};

/// Candidate pairs, with the image of the second discs.
pub type PairList = ([f32; 2], Vec<[u32; 2]>);

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
    /// Discs of each block but the last, a power of two.
    size: usize,
    blocks: Vec<NearBlock>,
    parts: Vec<Part>,
    /// Neighbours found after discs have left their bounds, sorted by disc.
    later: Vec<(u32, Neighbor)>,
    /// Those of them that are neighbours in later windows too.
    lasting: Vec<(u32, Neighbor)>,
    /// Whether a disc has any of these; empty if none has.
    has_later: Vec<bool>,
    images: Images,
    /// The number of the image of each list of candidate pairs.
    codes: Vec<u32>,
}

/// The neighbours of the discs of a block, a range of discs.
#[derive(Debug, Default)]
pub struct NearBlock {
    /// The first disc.
    first: u32,
    /// The number of discs.
    len: usize,
    /// Which candidate pairs have both discs in this block: the number of their list, and their range
    /// in it.
    pub inside: Vec<(u32, Range<u32>)>,
    /// The candidate pairs that have one disc in this block, with the image of the second.
    pub across: Vec<([u32; 2], u32)>,
    /// `all[starts[i]..starts[i + 1]]` are the neighbours of disc `first + i`.
    starts: Vec<u32>,
    all: Vec<Neighbor>,
}

/// Some of the candidate pairs, sorted by blocks.
#[derive(Debug, Default)]
struct Part {
    /// The block, and the range of pairs in the list.
    inside: Vec<(u32, Range<u32>)>,
    across: Vec<[u32; 2]>,
}

/// Candidate pairs that one thread sorts by blocks at a time.
const PAIRS: usize = 1 << 14;

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
        // Image 0 is its own opposite, so it takes two numbers, and k ^ 1 holds for all others.
        if offset == [0.0; 2] {
            return 0;
        }
        if let Some(&number) = self.numbers.get(&Self::bits(offset)) {
            return number;
        }
        let number = self.offsets.len() as u32;
        // Both directions get their numbers together, so that `opposite` is one operation without a
        // table.
        for (number, offset) in [(number, offset), (number + 1, offset.map(|v| -v))] {
            self.offsets.push(offset);
            self.numbers.insert(Self::bits(offset), number);
        }
        number
    }

    /// 0 + v, so that no offset is −0.
    fn bits(offset: Vector) -> [u64; 2] {
        offset.map(|v| (0.0 + v).to_bits())
    }
}

impl Part {
    /// Takes pairs that begin at `start` of their list.
    fn fill(&mut self, pairs: &[[u32; 2]], start: u32, size: u32) -> Result<()> {
        self.inside.clear();
        self.across.clear();
        let mut at = 0;
        while let Some(&[a, b]) = pairs.get(at) {
            let block = a / size;
            let is_inside = |disc: u32| disc.wrapping_sub(block * size) < size;
            if !is_inside(b) {
                memory::push(&mut self.across, [a, b])?;
                at += 1;
                continue;
            }
            // The search writes pairs in tree order, so most of a list are long runs of one block.
            // A run is stored as a range, and no pair is copied.
            let run = pairs[at..].iter().take_while(|[a, b]| is_inside(*a) & is_inside(*b));
            let end = at + run.count();
            memory::push(&mut self.inside, (block, start + at as u32..start + end as u32))?;
            at = end;
        }
        Ok(())
    }
}

impl NearBlock {
    /// Lists the neighbours of each disc.
    fn fill(&mut self, lists: &[PairList], codes: impl Fn(u32) -> u32) -> Result<()> {
        let Self { first, len, inside, across, starts, all } = self;
        let place = |disc: u32| disc.wrapping_sub(*first) as usize;
        let of_inside = || {
            inside.iter().map(|(list, range)| {
                let pairs = &lists[*list as usize].1;
                (&pairs[range.start as usize..range.end as usize], codes(*list))
            })
        };
        let of_across =
            || {
                across.iter().map(|&([a, b], code)| {
                    if place(a) < *len { (a, b, code) } else { (b, a, opposite(code)) }
                })
            };
        // Sorting by counting keeps the order of the input within each disc. So the order of
        // neighbours follows from the lists of pairs.
        memory::resize(starts, *len + 1, 0)?;
        starts.fill(0);
        let ends = &mut starts[1..];
        for (pairs, _) in of_inside() {
            for pair in pairs {
                pair.iter().for_each(|&disc| ends[place(disc)] += 1);
            }
        }
        of_across().for_each(|(disc, ..)| ends[place(disc)] += 1);
        let all_len = ends.iter().sum::<u32>() as usize;
        memory::resize(all, all_len, Neighbor::default())?;
        // `ends` has the next free place of each disc until all are written.
        sorting::prefix_sum(ends);
        let mut put = |disc: u32, index: u32, image: u32| {
            let next = &mut ends[place(disc)];
            all[*next as usize] = Neighbor { index, image };
            *next += 1;
        };
        for (pairs, code) in of_inside() {
            for &[a, b] in pairs {
                put(a, b, code);
                put(b, a, opposite(code));
            }
        }
        of_across().for_each(|(disc, index, image)| put(disc, index, image));
        Ok(())
    }

    /// The neighbours of a disc of this block.
    #[inline(always)]
    fn of(&self, disc: u32) -> &[Neighbor] {
        let index = (disc - self.first) as usize;
        &self.all[self.starts[index] as usize..self.starts[index + 1] as usize]
    }
}

impl Neighbors {
    /// Takes the candidate pairs, a list for each image: the first of a pair, moved by minus the
    /// image, is near the second. A block has `size` discs of all `len`.
    /// `offsets` are those images, exactly.
    pub fn fill(
        &mut self,
        len: usize,
        (lists, offsets): (&[PairList], impl Iterator<Item = Vector>),
        size: usize,
        threads: Option<usize>,
    ) -> Result<()> {
        let Self { blocks, parts, later, lasting, has_later, images, codes, .. } = self;
        self.size = size;
        later.clear();
        lasting.clear();
        has_later.clear();
        images.clear();
        codes.clear();
        codes.extend(offsets.map(|offset| images.number(offset)));
        let chunks = || {
            let lists = (0..).zip(lists);
            lists.flat_map(|(list, (_, pairs))| {
                pairs.chunks(PAIRS).zip((0..).step_by(PAIRS)).map(move |part| (list, part))
            })
        };
        let count = chunks().count();
        memory::resize_default(parts, parts.len().max(count))?;
        let parts = &mut parts[..count];
        // Each thread sorts its own chunk of pairs into its own part. No two threads write to the
        // same block.
        let tasks = parts.iter_mut().zip(chunks());
        parallel::try_for_each(threads, tasks, |(part, (_, (pairs, start)))| {
            part.fill(pairs, start, size as u32)
        })?;
        memory::resize_default(blocks, blocks.len().max(len.div_ceil(size)))?;
        for (block, first) in blocks.iter_mut().zip((0..).step_by(size)) {
            block.first = first as u32;
            block.len = size.min(len.saturating_sub(first));
            block.inside.clear();
            block.across.clear();
        }
        // The parts are joined on one thread in their order. The lists of a block are then the same
        // for any number of threads.
        for (part, (list, _)) in parts.iter().zip(chunks()) {
            let code = codes[list as usize];
            for (block, range) in &part.inside {
                memory::push(&mut blocks[*block as usize].inside, (list, range.clone()))?;
            }
            for &pair in &part.across {
                for disc in pair {
                    memory::push(&mut blocks[disc as usize / size].across, (pair, code))?;
                }
            }
        }
        let blocks = &mut blocks[..len.div_ceil(size)];
        parallel::try_for_each(threads, blocks.iter_mut(), |block| {
            block.fill(lists, |list| codes[list as usize])
        })
    }

    /// The neighbours of the discs of a block.
    pub fn block(&self, number: usize) -> &NearBlock {
        &self.blocks[number]
    }

    /// The neighbours of a disc that were found first.
    #[inline(always)]
    pub fn at_start(&self, disc: u32) -> &[Neighbor] {
        self.blocks[disc as usize / self.size].of(disc)
    }

    /// Calls `act` with each neighbour of a disc.
    #[inline(always)]
    pub fn of(&self, index: u32, mut act: impl FnMut(&Neighbor)) {
        let has_later = self.has_later.get(index as usize).is_some_and(|&has| has);
        let later = if has_later { &self.later[self.later_of(index)] } else { &[] };
        // One call of `act`, so that it is inlined.
        for neighbor in self.at_start(index).iter().chain(later.iter().map(|(_, found)| found)) {
            act(neighbor);
        }
    }

    /// Calls `act` with each disc of a block, a range of discs, and each of its neighbours that belongs
    /// to another block.
    pub fn each_across(
        &self,
        number: usize,
        range: &Range<u32>,
        mut act: impl FnMut(u32, Neighbor),
    ) {
        for &([a, b], image) in &self.blocks[number].across {
            if range.contains(&a) {
                act(a, Neighbor { index: b, image });
            } else {
                act(b, Neighbor { index: a, image: opposite(image) });
            }
        }
        let from = |disc: u32| self.later.partition_point(|&(of, _)| of < disc);
        for &(of, neighbor) in &self.later[from(range.start)..from(range.end)] {
            if !range.contains(&neighbor.index) {
                act(of, neighbor);
            }
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

    /// Loads the neighbours of the discs of a block into the cache.
    pub fn load(&self, number: usize) {
        cache::load(&self.blocks[number].all);
        cache::load(&self.blocks[number].starts);
    }

    /// The number of the image of a list of candidate pairs.
    pub fn code(&self, list: u32) -> u32 {
        self.codes[list as usize]
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
    pub fn add(&mut self, pairs: &[NearPair], new: &mut Vec<(u32, Neighbor)>) -> Result<()> {
        let key = |&(of, found): &(u32, Neighbor)| (of, found.index, found.image);
        new.clear();
        memory::reserve(new, pairs.len())?;
        memory::reserve(&mut self.lasting, 2 * pairs.len())?;
        for &NearPair { pair: [a, b], offset, lasts } in pairs {
            let image = self.images.number(offset);
            let both = [
                (a, Neighbor { index: b, image }),
                (b, Neighbor { index: a, image: opposite(image) }),
            ];
            // A pair twice in the list would have two events at the same moment.
            if self.is_near_at_start(&both[0]) {
                continue;
            }
            // One direction only: a new pair is tested once for a conflict.
            new.push(both[usize::from(b < a)]);
            if lasts {
                self.lasting.extend(both);
            }
        }
        new.sort_unstable_by_key(key);
        // Both discs may have left their bounds and found each other.
        new.dedup_by_key(|pair| key(pair));
        new.retain(|pair| self.later.binary_search_by_key(&key(pair), key).is_err());
        memory::reserve(&mut self.later, 2 * new.len())?;
        for &(a, Neighbor { index: b, image }) in new.iter() {
            self.later.push((a, Neighbor { index: b, image }));
            self.later.push((b, Neighbor { index: a, image: opposite(image) }));
        }
        self.later.sort_unstable_by_key(key);
        let len = self.blocks.iter().map(|block| block.len).sum();
        memory::resize(&mut self.has_later, len, false)?;
        new.iter().flat_map(|&(a, found)| [a, found.index]).for_each(|of| {
            self.has_later[of as usize] = true;
        });
        Ok(())
    }

    /// Forgets the neighbours that were added for the window before.
    pub fn begin_window(&mut self) -> Result<()> {
        let Self { later, lasting, has_later, .. } = self;
        if later.is_empty() {
            return Ok(());
        }
        let key = |&(of, found): &(u32, Neighbor)| (of, found.index, found.image);
        lasting.sort_unstable_by_key(key);
        lasting.dedup_by_key(|pair| key(pair));
        // The memory of `later` is kept, so a window allocates nothing here.
        memory::assign(later, lasting)?;
        has_later.fill(false);
        later.iter().for_each(|&(of, _)| has_later[of as usize] = true);
        Ok(())
    }

    /// Whether a pair was one of the candidate pairs.
    fn is_near_at_start(&self, &(a, Neighbor { index: b, image }): &(u32, Neighbor)) -> bool {
        let near = |of: u32| self.at_start(of);
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
