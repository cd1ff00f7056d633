//! What is reached on unseen cameras: what the terms that the paper does not have are worth, measured on cameras and
//! frames that nothing was fitted or tuned on.

pub mod bracket;
pub mod chains;
pub mod checkerboard;
pub mod decay;
pub mod denoise;
pub mod figure;
pub mod figures;
pub mod held_out;
mod light;
mod noise_free;
pub mod real_cameras;
pub mod response;
pub mod self_calibration;
pub mod sigma;
pub mod still;
pub mod targets;
