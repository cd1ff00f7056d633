//! One room for each step of the chain: what it is planned from, and what it does to a frame.
//!
//! | step | takes | sets |
//! |---|---|---|
//! | [`response`] | amplitude and what tells the fill of the pixel | SATURATED, INVALID |
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
pub(super) mod response;
pub(super) mod sigma;
pub(super) mod specular;
pub(super) mod time;
