//! The errors of calls, each with a message of one sentence.

use std::fmt;

/// A wrong argument, a failed allocation, an exceeded limit, or an interrupted call.
///
/// The message names the argument, the index and the value.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// The caller stopped the call; see [`watch`](crate::interrupt::watch).
    Interrupted,
    /// An allocation failed.
    NoMemory {
        /// Size of the allocation in bytes.
        bytes: usize,
    },
    /// One value breaks the rule of its argument.
    Value {
        /// Name of the argument in the public API.
        argument: &'static str,
        /// Row of the value if the argument has rows.
        index: Option<usize>,
        /// The value as text.
        value: String,
        /// The rule for valid values.
        rule: String,
    },
    /// Nothing has an id that was given.
    MissingId {
        /// Name of the argument in the public API.
        argument: &'static str,
        /// Row of the id if the argument has rows.
        index: Option<usize>,
        /// The id, or what refers to it, as text.
        value: String,
        /// What has no such id.
        rule: String,
    },
    /// One entry of an array with several axes breaks the rule of its argument.
    Entry {
        /// Name of the argument in the public API.
        argument: &'static str,
        /// Its index along each axis.
        indices: Vec<usize>,
        /// The value as text.
        value: String,
        /// The rule for valid values.
        rule: String,
    },
    /// An argument has the wrong number of rows.
    Length {
        /// Name of the argument.
        argument: &'static str,
        /// Number of its rows.
        found: usize,
        /// Number of rows that it must have.
        expected: usize,
    },
    /// A step of a world has more candidate pairs than it can store.
    TooManyCandidates {
        /// Maximum number of candidate pairs.
        limit: usize,
    },
    /// A step would give a particle an infinite number or NaN.
    NotFinite {
        /// Name of the column for the caller.
        argument: &'static str,
        /// Row of the particle.
        index: usize,
        /// Its id.
        id: i64,
        /// The new value as text.
        value: String,
    },
    /// A particle has more collisions than a step may have.
    TooManyCollisions {
        /// Its id.
        id: i64,
        /// Maximum number of collisions of a particle.
        limit: u32,
    },
    /// The queries of a call find more ids than one answer may have.
    TooManyIds {
        /// Maximum number of ids.
        limit: usize,
    },
    /// Another rank of a distributed world has failed.
    OtherRank {
        /// Its number.
        rank: usize,
    },
    /// More pairs overlap than the caller allows.
    TooManyPairs {
        /// Maximum number of pairs.
        max_pairs: usize,
    },
}

impl Error {
    /// An error about the value at `index` of `argument`.
    pub fn at(argument: &'static str, index: usize, value: impl fmt::Display, rule: &str) -> Self {
        Self::Value { argument, index: Some(index), value: printed(value), rule: rule.to_string() }
    }

    /// An error about the id at `index` of `argument`, which nothing has.
    pub fn missing(
        argument: &'static str,
        index: usize,
        value: impl fmt::Display,
        rule: &str,
    ) -> Self {
        Self::MissingId {
            argument,
            index: Some(index),
            value: printed(value),
            rule: rule.to_string(),
        }
    }

    /// An error about an entry of `argument`, whose entries are in row-major order; `shape` is that
    /// of the axes but the first.
    pub fn in_array(
        argument: &'static str,
        index: usize,
        shape: &[usize],
        value: impl fmt::Display,
        rule: &str,
    ) -> Self {
        let (mut left, mut indices) = (index, Vec::new());
        // Row-major order: the last axis varies fastest, so its index is the first remainder.
        for size in shape.iter().rev() {
            indices.insert(0, left % size);
            left /= size;
        }
        indices.insert(0, left);
        Self::Entry { argument, indices, value: printed(value), rule: rule.to_string() }
    }

    /// The same error about the value in `row`.
    pub fn in_row(self, row: usize) -> Self {
        match self {
            Self::Value { argument, value, rule, .. } => {
                Self::Value { argument, index: Some(row), value, rule }
            }
            other => other,
        }
    }

    /// The same error without a row, for an argument that is a single value.
    pub fn without_row(self) -> Self {
        match self {
            Self::Value { argument, value, rule, .. }
            | Self::Entry { argument, value, rule, .. } => {
                Self::Value { argument, index: None, value, rule }
            }
            Self::MissingId { argument, value, rule, .. } => {
                Self::MissingId { argument, index: None, value, rule }
            }
            other => other,
        }
    }

    /// An error about `argument` as a whole.
    pub fn of(argument: &'static str, value: impl fmt::Display, rule: &str) -> Self {
        Self::Value { argument, index: None, value: printed(value), rule: rule.to_string() }
    }

    /// The same error; a failed allocation for a part of an answer reports the size of the
    /// whole answer, at least `bytes`.
    pub fn in_all(self, bytes: usize) -> Self {
        match self {
            Self::NoMemory { bytes: part } => Self::NoMemory { bytes: bytes.max(part) },
            other => other,
        }
    }

    /// The same error; a limit of pairs for a part of a search becomes that of the whole search.
    pub fn with_max_pairs(self, max_pairs: usize) -> Self {
        if let Self::TooManyPairs { .. } = self { Self::TooManyPairs { max_pairs } } else { self }
    }

    /// The bytes that could not be allocated; 0 for other errors.
    pub fn bytes(&self) -> usize {
        if let Self::NoMemory { bytes } = self { *bytes } else { 0 }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interrupted => write!(f, "the call was interrupted"),
            Self::NoMemory { bytes } => {
                write!(f, "not enough memory: {} could not be allocated", Size(*bytes))
            }
            Self::Value { argument, index: Some(index), value, rule }
            | Self::MissingId { argument, index: Some(index), value, rule } => {
                write!(f, "{argument}[{index}] is {value}; {rule}")
            }
            Self::Value { argument, index: None, value, rule }
            | Self::MissingId { argument, index: None, value, rule } => {
                write!(f, "{argument} is {value}; {rule}")
            }
            Self::Entry { argument, indices, value, rule } => {
                let indices: Vec<String> = indices.iter().map(usize::to_string).collect();
                write!(f, "{argument}[{}] is {value}; {rule}", indices.join(", "))
            }
            Self::Length { argument, found, expected } => {
                write!(
                    f,
                    "{argument} has {found} rows; it must have {expected}, one for each shape"
                )
            }
            Self::TooManyCandidates { limit } => write!(
                f,
                "more than {limit} pairs of particles may touch in one step; \
                 spread the particles out, or take smaller steps"
            ),
            Self::NotFinite { argument, index, id, value } => write!(
                f,
                "the step would make {argument}[{index}]{} {value}, which is not finite; the world \
                 is as it was before this step: take smaller steps, or smaller masses, forces or \
                 speeds",
                if *id == *index as i64 { String::new() } else { format!(" of particle {id}") }
            ),
            Self::TooManyCollisions { id, limit } => write!(
                f,
                "particle {id} has more than {limit} collisions in one step; the world is as it was \
                 before this step: take smaller steps, or smaller speeds"
            ),
            Self::TooManyIds { limit } => {
                write!(f, "the answer has more than {limit} ids; query fewer regions in one call")
            }
            Self::OtherRank { rank } => write!(f, "rank {rank} could not do its part of the step"),
            Self::TooManyPairs { max_pairs } => write!(
                f,
                "more than max_pairs = {max_pairs} pairs overlap; \
                 raise max_pairs if the memory for them is there"
            ),
        }
    }
}

impl std::error::Error for Error {}

/// Numbers with more characters are printed with an exponent.
const MAX_CHARACTERS: usize = 20;

/// A number with the noun that it counts: "1 kind", "2 kinds".
pub fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// The text of a value, with an exponent if it is a long number.
fn printed(value: impl fmt::Display) -> String {
    let text = value.to_string();
    match text.parse::<f64>() {
        // 1e300 as a decimal number has 301 digits, and the rule at the end of the sentence would
        // be lost behind them. The exponent form is as exact: both read back as the same float64.
        Ok(number) if text.len() > MAX_CHARACTERS => format!("{number:e}"),
        _ => text,
    }
}

/// A number of bytes in the largest unit that leaves at least 1.
struct Size(usize);

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = self.0 as f64;
        match self.0 {
            0..1024 => write!(f, "{} bytes", self.0),
            1024..1_048_576 => write!(f, "{:.1} KiB", bytes / 1024.0),
            1_048_576..1_073_741_824 => write!(f, "{:.1} MiB", bytes / 1_048_576.0),
            _ => write!(f, "{:.1} GiB", bytes / 1_073_741_824.0),
        }
    }
}

/// A result whose error is [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_numbers_have_an_exponent() {
        let text = |value: f64| Error::of("dt", value, "no").to_string();
        assert_eq!(text(1e-300), "dt is 1e-300; no");
        assert_eq!(text(-1.25e300), "dt is -1.25e300; no");
        assert_eq!(text(0.001), "dt is 0.001; no");
        assert_eq!(
            Error::at("ids", 2, i64::MIN, "no").to_string(),
            format!("ids[2] is {}; no", i64::MIN)
        );
        assert_eq!(Error::of("drag", 1e-30_f32, "no").to_string(), "drag is 1e-30; no");
    }

    #[test]
    fn an_entry_has_an_index_for_each_axis() {
        let text = |index| Error::in_array("table", index, &[2, 3], 0.5, "no").to_string();
        assert_eq!(text(0), "table[0, 0, 0] is 0.5; no");
        assert_eq!(text(10), "table[1, 1, 1] is 0.5; no");
        assert_eq!(counted(1, "kind") + &counted(0, "kind"), "1 kind0 kinds");
    }

    #[test]
    fn an_error_of_memory_names_the_larger_size() {
        let bytes = |error: Error| error.to_string();
        let part = Error::NoMemory { bytes: 2048 };
        assert!(bytes(part.clone().in_all(3 << 20)).contains("3.0 MiB"));
        assert!(bytes(part.in_all(10)).contains("2.0 KiB"));
        assert_eq!(Error::Interrupted.in_all(10), Error::Interrupted);
    }
}
