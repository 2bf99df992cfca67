//! Numbers of numpy arrays, read where they lie.

use numpy::ndarray::ArrayView2;
use numpy::{PyArray3, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use trueray::{DVec3, Picture};

use crate::errors::exception;

/// A table with a row for each sphere or light, of any strides.
#[derive(FromPyObject)]
pub(crate) enum Table<'py> {
    Double(PyReadonlyArray2<'py, f64>),
    Single(PyReadonlyArray2<'py, f32>),
    Level(PyReadonlyArray2<'py, u8>),
}

impl Table<'_> {
    pub(crate) fn view(&self) -> View<'_> {
        match self {
            Self::Double(array) => View::Double(array.as_array()),
            Self::Single(array) => View::Single(array.as_array()),
            Self::Level(array) => View::Level(array.as_array()),
        }
    }
}

/// A [`Table`] that is being read.
pub(crate) enum View<'a> {
    Double(ArrayView2<'a, f64>),
    Single(ArrayView2<'a, f32>),
    /// 0 to 255, which mean 0 to 1.
    Level(ArrayView2<'a, u8>),
}

impl View<'_> {
    pub(crate) fn rows(&self) -> usize {
        match self {
            Self::Double(view) => view.nrows(),
            Self::Single(view) => view.nrows(),
            Self::Level(view) => view.nrows(),
        }
    }

    pub(crate) fn number(&self, row: usize, column: usize) -> f64 {
        match self {
            Self::Double(view) => view[[row, column]],
            Self::Single(view) => view[[row, column]].into(),
            Self::Level(view) => f64::from(view[[row, column]]) / 255.0,
        }
    }

    pub(crate) fn triple(&self, row: usize) -> DVec3 {
        DVec3::new(self.number(row, 0), self.number(row, 1), self.number(row, 2))
    }
}

/// The picture as an array (height, width, 3), which takes over its memory.
pub(crate) fn array(py: Python<'_>, picture: Picture) -> PyResult<Bound<'_, PyArray3<u8>>> {
    let shape = [picture.height() as usize, picture.width() as usize, 3];
    numpy::PyArray1::from_vec(py, picture.into_rgb()).reshape(shape)
}

/// The picture that an array (height, width, 3) holds.
pub(crate) fn picture(array: &PyReadonlyArray3<'_, u8>) -> PyResult<Picture> {
    let [height, width, _] = array.shape().try_into().expect("it has three dimensions");
    let side = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    Picture::new(side(width), side(height), array.as_array().iter().copied().collect()).map_err(exception)
}
