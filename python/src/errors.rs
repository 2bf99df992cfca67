//! Errors of the library as exceptions of `package/trueray/_errors.py`.

use pyo3::PyErr;
use trueray::Error;

mod python {
    pyo3::import_exception!(trueray._errors, DeviceError);
    pyo3::import_exception!(trueray._errors, Error);
    pyo3::import_exception!(trueray._errors, PictureError);
    pyo3::import_exception!(trueray._errors, SceneError);
}

/// The exception of `error`, with its message.
pub(crate) fn exception(error: impl Into<Error>) -> PyErr {
    let error = error.into();
    let message = error.to_string();
    match error {
        Error::Scene(_) | Error::Invalid(_) | Error::Unrenderable(_) => python::SceneError::new_err(message),
        Error::Device(_) => python::DeviceError::new_err(message),
        Error::Size(_) | Error::Picture(_) | Error::Read(_) | Error::Write(_) => python::PictureError::new_err(message),
        _ => python::Error::new_err(message),
    }
}
