//! What follows from the arguments of a class of forces: attributes, `__match_args__`, pickle, hash and repr.

use jostle_base::Id;
use numpy::IntoPyArray;
use numpy::ndarray::Array3;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyTuple, PyType};

use crate::arrays::{column, decimal, read_only, table};

/// Declares the arguments of a class, which are its attributes: those by position, then those by keyword alone.
/// Each has its documentation, its name, and its value.
macro_rules! arguments {
    (
        $class:ident { $($(#[$doc:meta])* $name:ident: $value:expr;)* }
        $(keywords { $($(#[$keyword_doc:meta])* $keyword:ident: $keyword_value:expr;)* })?
    ) => {
        #[pyo3::pymethods]
        #[allow(non_snake_case, reason = "the usual name of a constant")]
        impl $class {
            #[classattr]
            fn __match_args__(
                py: pyo3::Python<'_>,
            ) -> pyo3::PyResult<pyo3::Bound<'_, pyo3::types::PyTuple>> {
                pyo3::types::PyTuple::new(py, [$(stringify!($name)),*])
            }

            $($(#[$doc])*
            #[getter]
            fn $name<'py>(&self, py: pyo3::Python<'py>) -> crate::forces::arguments::Shown<'py> {
                let value: fn(&Self) -> _ = $value;
                crate::forces::arguments::Show::show(value(self), py)
            })*

            $($($(#[$keyword_doc])*
            #[getter]
            fn $keyword<'py>(&self, py: pyo3::Python<'py>) -> crate::forces::arguments::Shown<'py> {
                let value: fn(&Self) -> _ = $keyword_value;
                crate::forces::arguments::Show::show(value(self), py)
            })*)?

            fn __getnewargs_ex__<'py>(
                &self,
                py: pyo3::Python<'py>,
            ) -> pyo3::PyResult<crate::forces::arguments::Arguments<'py>> {
                let positional = vec![$(self.$name(py)?),*];
                let keywords: Vec<(&str, _)> =
                    vec![$($((stringify!($keyword), self.$keyword(py)?)),*)?];
                crate::forces::arguments::arguments_of(py, positional, keywords)
            }
        }
    };
}
pub(super) use arguments;

/// Implements hash and repr by the arguments of a class, which are numbers, words and tuples.
macro_rules! plain_arguments {
    ($class:ident) => {
        #[pyo3::pymethods]
        impl $class {
            fn __hash__(&self, py: pyo3::Python<'_>) -> pyo3::PyResult<isize> {
                crate::forces::arguments::hash(self.__getnewargs_ex__(py)?)
            }

            fn __repr__(&self, py: pyo3::Python<'_>) -> pyo3::PyResult<String> {
                let class = py.get_type::<Self>();
                crate::forces::arguments::repr(&class, self.__getnewargs_ex__(py)?)
            }
        }
    };
}
pub(super) use plain_arguments;

/// The value of an attribute.
pub type Shown<'py> = PyResult<Bound<'py, PyAny>>;

/// Arguments by position and by keyword.
pub type Arguments<'py> = (Bound<'py, PyTuple>, Bound<'py, PyDict>);

pub fn arguments_of<'py>(
    py: Python<'py>,
    positional: Vec<Bound<'py, PyAny>>,
    keywords: Vec<(&str, Bound<'py, PyAny>)>,
) -> PyResult<Arguments<'py>> {
    Ok((PyTuple::new(py, positional)?, keywords.into_py_dict(py)?))
}

pub fn hash((positional, keywords): Arguments<'_>) -> PyResult<isize> {
    (positional, keywords.items().to_tuple()).into_pyobject(keywords.py())?.hash()
}

/// A call of the class. Keywords that are None or empty are left out.
pub fn repr(class: &Bound<'_, PyType>, (positional, keywords): Arguments<'_>) -> PyResult<String> {
    let mut all = Vec::new();
    for value in positional {
        all.push(value.repr()?.to_string());
    }
    for (keyword, value) in keywords {
        if !value.is_none() && (value.len().is_err() || !value.is_empty()?) {
            all.push(format!("{keyword}={}", shown(&value)?));
        }
    }
    Ok(format!("{}({})", class.name()?, all.join(", ")))
}

/// The repr of a value; that of a tuple of sides has their names alone, which are expressions.
fn shown(value: &Bound<'_, PyAny>) -> PyResult<String> {
    let side = value.py().import("jostle")?.getattr("Side")?;
    let Ok(all) = value.cast::<PyTuple>() else { return Ok(value.repr()?.to_string()) };
    if !all.get_item(0)?.is_instance(&side)? {
        return Ok(all.repr()?.to_string());
    }
    let names = all.iter().map(|of| Ok(format!("Side.{}", of.getattr("name")?)));
    let names = names.collect::<PyResult<Vec<_>>>()?;
    Ok(if let [one] = &names[..] { format!("({one},)") } else { format!("({})", names.join(", ")) })
}

/// A value that becomes an attribute.
pub trait Show {
    fn show(self, py: Python<'_>) -> Shown<'_>;
}

macro_rules! shows {
    ($($type:ty: |$py:ident, $value:ident| $show:expr;)*) => {$(
        impl Show for $type {
            fn show(self, $py: Python<'_>) -> Shown<'_> {
                let $value = self;
                $show
            }
        }
    )*};
}
shows! {
    f32: |py, value| decimal(value).into_bound_py_any(py);
    u32: |py, value| value.into_bound_py_any(py);
    Id: |py, value| value.into_bound_py_any(py);
    &'static str: |py, value| value.into_bound_py_any(py);
    [f32; 2]: |py, value| <(f64, f64)>::from(value.map(decimal)).into_bound_py_any(py);
    [f32; 4]: |py, value| Ok(PyTuple::new(py, value.map(decimal))?.into_any());
    Vec<u8>: |py, value| Ok(read_only(column(py, value)).into_any());
    Vec<f32>: |py, value| Ok(read_only(column(py, value)).into_any());
    Vec<Id>: |py, value| Ok(read_only(column(py, value)).into_any());
    Vec<[Id; 2]>: |py, value| Ok(read_only(table(py, value)?).into_any());
    Array3<f32>: |py, value| Ok(read_only(value.into_pyarray(py)).into_any());
    Numbers: |py, value| Ok(PyTuple::new(py, value.0)?.into_any());
    Sides: |py, value| {
        let side = py.import("jostle")?.getattr("Side")?;
        let all = value.0.into_iter().map(|id| side.call1((id,))).collect::<PyResult<Vec<_>>>()?;
        Ok(PyTuple::new(py, all)?.into_any())
    };
}

/// Whole numbers as a tuple.
pub struct Numbers(pub Vec<i64>);

/// Sides of a container by their ids, as a tuple of `jostle.Side`.
pub struct Sides(pub Vec<i64>);

impl<S: Show> Show for Option<S> {
    fn show(self, py: Python<'_>) -> Shown<'_> {
        self.map_or(Ok(py.None().into_bound(py)), |value| value.show(py))
    }
}
