//! The errors of calls, each with a message of one sentence.

use std::fmt;

/// A wrong argument, an answer that does not fit into memory, or an interrupted call.
///
/// The sentence names the argument, the index and the value, so that a caller
/// with a million rows can find the one that is wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// The caller asked for a stop; see [`watch`](crate::interrupt::watch).
    Interrupted,
    /// An allocation failed.
    NoMemory {
        /// Size of the allocation in bytes.
        bytes: usize,
    },
    /// One value breaks the rule of its argument.
    Value {
        /// Name of the argument, as the caller spells it.
        argument: &'static str,
        /// Row of the value, where the argument has rows.
        index: Option<usize>,
        /// The value, printed.
        value: String,
        /// What would have been right.
        rule: String,
    },
    /// Two arguments that belong together differ in length.
    Length {
        /// Name of the argument.
        argument: &'static str,
        /// Rows it has.
        found: usize,
        /// Rows it should have.
        expected: usize,
    },
    /// More pairs may touch in one step of a world than it has room for.
    TooManyCandidates {
        /// The limit that was passed.
        most: usize,
    },
    /// A step would give a particle an infinite number or NaN.
    NotFinite {
        /// Name of the column for the caller.
        argument: &'static str,
        /// Row of the particle.
        index: usize,
        /// The new value as text.
        value: String,
    },
    /// Questions have more answers than memory is set aside for.
    TooManyIds {
        /// The limit that was passed.
        most: usize,
    },
    /// More pairs overlap than the caller is ready to receive.
    TooManyPairs {
        /// The limit that was passed.
        max_pairs: usize,
    },
}

impl Error {
    /// Refuses the value at `index` of `argument`.
    pub fn at(argument: &'static str, index: usize, value: impl fmt::Display, rule: &str) -> Self {
        Self::Value {
            argument,
            index: Some(index),
            value: value.to_string(),
            rule: rule.to_string(),
        }
    }

    /// The same refusal of a value, once it is known in which row it stands.
    pub fn in_row(self, row: usize) -> Self {
        match self {
            Self::Value { argument, value, rule, .. } => {
                Self::Value { argument, index: Some(row), value, rule }
            }
            other => other,
        }
    }

    /// Refuses `argument` as a whole.
    pub fn of(argument: &'static str, value: impl fmt::Display, rule: &str) -> Self {
        Self::Value { argument, index: None, value: value.to_string(), rule: rule.to_string() }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interrupted => write!(f, "the call was interrupted"),
            Self::NoMemory { bytes } => {
                write!(f, "not enough memory: {} could not be allocated", Size(*bytes))
            }
            Self::Value { argument, index: Some(index), value, rule } => {
                write!(f, "{argument}[{index}] is {value}; {rule}")
            }
            Self::Value { argument, index: None, value, rule } => {
                write!(f, "{argument} is {value}; {rule}")
            }
            Self::Length { argument, found, expected } => {
                write!(
                    f,
                    "{argument} has {found} rows; it must have {expected}, one for each shape"
                )
            }
            Self::TooManyCandidates { most } => write!(
                f,
                "more than {most} pairs of particles may touch in one step; \
                 spread the particles out, or take smaller steps"
            ),
            Self::NotFinite { argument, index, value } => write!(
                f,
                "the step would make {argument}[{index}] {value}, which is not finite; the world \
                 is as it was before this step: take smaller steps, or smaller masses, forces or \
                 speeds"
            ),
            Self::TooManyIds { most } => {
                write!(f, "the answer has more than {most} ids; query fewer regions in one call")
            }
            Self::TooManyPairs { max_pairs } => write!(
                f,
                "more than max_pairs = {max_pairs} pairs overlap; \
                 raise max_pairs if the memory for them is there"
            ),
        }
    }
}

impl std::error::Error for Error {}

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
