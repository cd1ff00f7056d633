//! Surfaces that the distances show: planes fitted to them, and the angle at which the light meets them.

mod incidence;
mod neighbourhood;
mod normals;

pub(crate) use incidence::Incidence;
