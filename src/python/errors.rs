//! One exception per error enum; the classes live in the facade.

use pyo3::{PyErr, import_exception};

use crate::contact::ContactError as ContactFailure;
use crate::hand::SkinningError as SkinningFailure;
use crate::lcp::LcpError as LcpFailure;
use crate::obstacle::ObstacleError as ObstacleFailure;
use crate::response::ResponseError as ResponseFailure;
use crate::surface::SurfaceError as SurfaceFailure;

import_exception!(quasirigid.errors, HandError);
import_exception!(quasirigid.errors, SurfaceError);
import_exception!(quasirigid.errors, ObstacleError);
import_exception!(quasirigid.errors, ResponseError);
import_exception!(quasirigid.lcp, LcpError);
import_exception!(quasirigid.contact.result, ContactError);

/// The exception that stands for an error of the crate.
pub(super) trait IntoPyErr {
    fn into_py_err(self) -> PyErr;
}

macro_rules! map_error {
    ($($failure:ty => $exception:ident),* $(,)?) => {
        $(impl IntoPyErr for $failure {
            fn into_py_err(self) -> PyErr {
                $exception::new_err(self.to_string())
            }
        })*
    };
}

map_error! {
    SurfaceFailure => SurfaceError,
    ObstacleFailure => ObstacleError,
    ResponseFailure => ResponseError,
    LcpFailure => LcpError,
    SkinningFailure => HandError,
}

impl IntoPyErr for ContactFailure {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::Obstacle(error) => error.into_py_err(),
            Self::Response(error) => error.into_py_err(),
            Self::Lcp(error) => error.into_py_err(),
            other => ContactError::new_err(other.to_string()),
        }
    }
}
