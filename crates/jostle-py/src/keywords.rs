//! Arguments of a call by name, with errors that name the call and suggest the right word.
//!
//! pyo3 names the method `__new__` in the errors of a constructor, so constructors read all their arguments here. Other
//! calls take all further keywords as `**unknown`, and refuse them with [`refuse_unknown`]. Arguments that must be
//! given are optional for pyo3, and [`read`] finds those that are missing: pyo3 would refuse `radius=1` because `radii`
//! is missing, without the misspelt name.

use jostle_base::error::counted;
use pyo3::PyTypeInfo;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};

use crate::arrays::Given;

/// Arguments of a call that are not read yet, by name.
///
/// A list: a search in a dict would make a Python string of each name, which costs more than comparing a few names.
pub struct Keywords<'py> {
    /// The call, for errors: `World()`.
    call: &'static str,
    left: Vec<(String, Bound<'py, PyAny>)>,
    /// All that the call reads.
    known: Vec<&'static str>,
}

impl<'py> Keywords<'py> {
    /// Those of a call.
    pub fn of(call: &'static str, all: Option<&Bound<'py, PyDict>>) -> PyResult<Self> {
        let mut left = Vec::with_capacity(all.map_or(0, PyDictMethods::len));
        for (name, value) in all.into_iter().flatten() {
            left.push((name.cast::<PyString>()?.to_cow()?.into_owned(), value));
        }
        Ok(Self { call, left, known: Vec::with_capacity(16) })
    }

    /// Those of a constructor, with the names of its arguments by position.
    pub fn of_all(
        call: &'static str,
        names: &[&'static str],
        positional: &Bound<'py, PyTuple>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Self> {
        let mut all = Self::of(call, keywords)?;
        if positional.len() > names.len() {
            let (most, found) = (counted(names.len(), "positional argument"), positional.len());
            let message = format!("{call} takes at most {most}, not {found}");
            return Err(PyTypeError::new_err(message));
        }
        for (name, value) in names.iter().zip(positional) {
            if all.left.iter().any(|(given, _)| given == name) {
                let message = format!("{call} got two values for argument '{name}'");
                return Err(PyTypeError::new_err(message));
            }
            all.left.push(((*name).to_string(), value));
        }
        Ok(all)
    }

    /// The values of arguments that must be given.
    pub fn require<const N: usize>(
        &mut self,
        names: [&'static str; N],
    ) -> PyResult<[Bound<'py, PyAny>; N]> {
        let all = names.map(|name| self.take(name));
        match names.iter().zip(&all).find(|(_, value)| value.is_none()) {
            Some((name, _)) => {
                // Perhaps it is given by a misspelt name.
                if let Some((given, _)) = self.left.iter().find(|(given, _)| is_near(name, given)) {
                    return Err(unexpected(self.call, given, &[*name]));
                }
                Err(missing(self.call, name))
            }
            None => Ok(all.map(|value| value.expect("each is given"))),
        }
    }

    /// The values of arguments that must be given, by position or by name.
    pub fn require_given<const N: usize>(
        &mut self,
        arguments: [(&'static str, Given<'py>); N],
    ) -> PyResult<[Bound<'py, PyAny>; N]> {
        let names = arguments.each_ref().map(|(name, _)| *name);
        for (name, given) in &arguments {
            self.left.extend(given.value().map(|value| ((*name).to_string(), value.clone())));
        }
        self.require(names)
    }

    /// The value of a keyword that may be omitted.
    pub fn given(&mut self, name: &'static str) -> Given<'py> {
        Given::of(self.take(name))
    }

    /// The value of a keyword, even if it is None.
    pub fn take(&mut self, name: &'static str) -> Option<Bound<'py, PyAny>> {
        self.known.push(name);
        let found = self.left.iter().position(|(given, _)| given == name);
        found.map(|index| self.left.remove(index).1)
    }

    /// The value of a keyword, if there is one and it is not None.
    pub fn take_some(&mut self, name: &'static str) -> Option<Bound<'py, PyAny>> {
        self.take(name).filter(|value| !value.is_none())
    }

    /// The values of some keywords that are there and not None.
    pub fn take_all<const N: usize>(
        &mut self,
        names: [&'static str; N],
    ) -> [Option<Bound<'py, PyAny>>; N] {
        names.map(|name| self.take_some(name))
    }

    /// Refuses the first keyword that nothing has read.
    pub fn end(self) -> PyResult<()> {
        let Some((name, _)) = self.left.first() else { return Ok(()) };
        Err(unexpected(self.call, name, &self.known))
    }
}

/// Refuses keywords that a method of a class does not have.
pub fn refuse_unknown<C: PyTypeInfo>(
    method: &str,
    unknown: Option<&Bound<'_, PyDict>>,
) -> PyResult<()> {
    let Some((name, _)) = unknown.into_iter().flatten().next() else { return Ok(()) };
    Err(unexpected_in(&name.py().get_type::<C>().getattr(method)?, &name)?)
}

/// The arguments that a method of a class must be given. Refuses all other keywords.
pub fn read<'a, 'py, C: PyTypeInfo, const N: usize>(
    method: &str,
    unknown: Option<&Bound<'_, PyDict>>,
    arguments: [(&str, &'a Given<'py>); N],
) -> PyResult<[&'a Bound<'py, PyAny>; N]> {
    refuse_unknown::<C>(method, unknown)?;
    required(arguments, |py| py.get_type::<C>().getattr(method))
}

/// The arguments that a function of the module must be given. Refuses all other keywords.
pub fn read_of_function<'a, 'py, const N: usize>(
    function: &str,
    unknown: Option<&Bound<'_, PyDict>>,
    arguments: [(&str, &'a Given<'py>); N],
) -> PyResult<[&'a Bound<'py, PyAny>; N]> {
    refuse_unknown_of_function(function, unknown)?;
    required(arguments, |py| py.import("jostle._core")?.getattr(function))
}

/// The values of arguments; an error that names the callable if one is missing.
fn required<'a, 'py, const N: usize>(
    arguments: [(&str, &'a Given<'py>); N],
    callable: impl for<'all> Fn(Python<'all>) -> PyResult<Bound<'all, PyAny>>,
) -> PyResult<[&'a Bound<'py, PyAny>; N]> {
    if let Some((name, _)) = arguments.iter().find(|(_, given)| given.value().is_none()) {
        return Err(Python::attach(|py| Ok(missing(&qualified(&callable(py)?)?, name)))
            .unwrap_or_else(|error: PyErr| error));
    }
    Ok(arguments.map(|(_, given)| given.value().expect("each is given")))
}

/// Refuses keywords that a function of the module does not have.
pub fn refuse_unknown_of_function(
    function: &str,
    unknown: Option<&Bound<'_, PyDict>>,
) -> PyResult<()> {
    let Some((name, _)) = unknown.into_iter().flatten().next() else { return Ok(()) };
    Err(unexpected_in(&name.py().import("jostle._core")?.getattr(function)?, &name)?)
}

/// The error for a keyword that a callable does not have. Its arguments are those in its signature.
fn unexpected_in(callable: &Bound<'_, PyAny>, name: &Bound<'_, PyAny>) -> PyResult<PyErr> {
    let signature: String = callable.getattr("__text_signature__")?.extract()?;
    let known: Vec<&str> = names_in(&signature).collect();
    Ok(unexpected(&qualified(callable)?, &name.cast::<PyString>()?.to_cow()?, &known))
}

/// How errors name a callable: `World.step()`.
fn qualified(callable: &Bound<'_, PyAny>) -> PyResult<String> {
    Ok(format!("{}()", callable.getattr("__qualname__")?.extract::<String>()?))
}

/// The error for an argument that is missing.
fn missing(call: &str, name: &str) -> PyErr {
    PyTypeError::new_err(format!("{call} is missing the argument '{name}'"))
}

/// The names of the arguments in a signature: `a` and `b` in `($self, a, *, b=(0, 1))`.
fn names_in(signature: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0;
    let arguments = signature.split(move |letter| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        // The parentheses around the arguments are of depth 1, those of a default inside them.
        depth <= 1 && matches!(letter, '(' | ')' | ',')
    });
    let names = arguments.map(|argument| argument.split('=').next().unwrap_or_default().trim());
    names.filter(|name| name.starts_with(|first: char| first.is_alphabetic()))
}

/// The error for a keyword that a call does not have.
fn unexpected(call: &str, name: &str, known: &[&str]) -> PyErr {
    // A singular, or another shortened name, is nearer than any other word: `mass` means masses, not masks.
    let measure = |known: &&&str| (!known.starts_with(name), distance(known, name));
    let closest = known.iter().min_by_key(measure);
    let closest = closest.filter(|known| is_near(known, name));
    let hint = closest.map_or_else(String::new, |known| format!("; did you mean '{known}'?"));
    PyTypeError::new_err(format!("{call} got an unexpected keyword argument '{name}'{hint}"))
}

/// Whether one word may be a misspelling or the beginning of the other.
fn is_near(known: &str, name: &str) -> bool {
    let letters = name.chars().count();
    letters > 2 && known.starts_with(name) || distance(known, name) <= 1 + letters / 4
}

/// The number of letters that must be added, removed or replaced to turn one word into the other.
fn distance(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (index, a) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = index + 1;
        for (k, &b) in to.iter().enumerate() {
            let replaced = diagonal + usize::from(a != b);
            diagonal = row[k + 1];
            row[k + 1] = replaced.min(row[k] + 1).min(diagonal + 1);
        }
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::names_in;

    #[test]
    fn the_names_of_arguments_are_read_from_a_signature() {
        let names = |signature| names_in(signature).collect::<Vec<_>>();
        assert_eq!(names("($self, ids, up=(0, -1), *, k=1)"), ["ids", "up", "k"]);
        assert_eq!(names("()"), [""; 0]);
        assert_eq!(names("(*, period=None)"), ["period"]);
    }
}
