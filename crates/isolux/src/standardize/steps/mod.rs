//! One module for each step of the chain, with its plan and its application to a frame.
//!
//! | step | reads | sets the flags |
//! |---|---|---|
//! | [`response`] | amplitude and the channel that shows the fill of the pixel | SATURATED, INVALID |
//! | [`time`] | integration time | TIME_OUT_OF_RANGE, INVALID |
//! | [`denoise`] | distance | |
//! | [`distance`] | distance | in the loop: DISTANCE_OUT_OF_RANGE, INVALID |
//! | [`profile`] | place in the image | ILLUMINATION_OUT_OF_RANGE |
//! | [`angle`] | normals from the distance | ILLUMINATION_OUT_OF_RANGE |
//! | [`sigma`] | noise | |
//! | [`specular`] | the whole standardized image | SPECULAR |

pub(super) mod angle;
pub(super) mod denoise;
pub(super) mod distance;
pub(super) mod profile;
mod relative;
pub(super) mod response;
pub(super) mod sigma;
pub(super) mod specular;
pub(super) mod time;
