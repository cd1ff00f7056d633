//! Beyond the paper: what the terms that it does not have are worth, measured on cameras and frames that nothing was
//! fitted or tuned on.

pub mod chains;
pub mod checkerboard;
pub mod decay;
pub mod denoise;
pub mod figure;
pub mod figures;
pub mod held_out;
pub mod still;
pub mod targets;
