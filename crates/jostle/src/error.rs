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
        /// Its id.
        id: i64,
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
        Self::Value { argument, index: Some(index), value: printed(value), rule: rule.to_string() }
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
        Self::Value { argument, index: None, value: printed(value), rule: rule.to_string() }
    }

    /// The same error, if a part of an answer that needs at least `bytes` in all could not be
    /// allocated.
    pub(crate) fn in_all(self, bytes: usize) -> Self {
        match self {
            Self::NoMemory { bytes: part } => Self::NoMemory { bytes: bytes.max(part) },
            other => other,
        }
    }

    /// The bytes that could not be allocated; 0 for other errors.
    pub(crate) fn bytes(&self) -> usize {
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
            Self::NotFinite { argument, index, id, value } => write!(
                f,
                "the step would make {argument}[{index}]{} {value}, which is not finite; the world \
                 is as it was before this step: take smaller steps, or smaller masses, forces or \
                 speeds",
                if *id == *index as i64 { String::new() } else { format!(" of particle {id}") }
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

/// Longer numbers are printed with an exponent.
const LONGEST: usize = 20;

/// The text of a value; that of a number is short.
fn printed(value: impl fmt::Display) -> String {
    let text = value.to_string();
    match text.parse::<f64>() {
        Ok(number) if text.len() > LONGEST => format!("{number:e}"),
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
    fn an_error_of_memory_names_the_larger_size() {
        let bytes = |error: Error| error.to_string();
        let part = Error::NoMemory { bytes: 2048 };
        assert!(bytes(part.clone().in_all(3 << 20)).contains("3.0 MiB"));
        assert!(bytes(part.in_all(10)).contains("2.0 KiB"));
        assert_eq!(Error::Interrupted.in_all(10), Error::Interrupted);
    }
}
