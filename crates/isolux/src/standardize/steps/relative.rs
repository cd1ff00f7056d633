//! The step that takes the factor out that all still pixels of a frame share.

use crate::common_factor::RelativeExposure;
use crate::standardize::planner::Planner;
use crate::standardize::report::{Note, PlanError};

/// Plans the step; adds a note, as frames become comparable with each other and with no other recording.
///
/// # Errors
/// [`PlanError::NothingStandsStill`] where no factors are known.
pub(super) fn plan(planner: &mut Planner<'_>) -> Result<(RelativeExposure, String), PlanError> {
    let exposure = planner.traits.relative_exposure.clone().ok_or(PlanError::NothingStandsStill)?;
    let ([least, largest], [compared, without]) = (exposure.range(), exposure.frames());
    planner.notes.push(Note::Relative { compared, without });
    let words = format!(
        "relative, not absolute: divides by what still pixels share, {least:.3} to {largest:.3} of the median frame"
    );
    Ok((exposure, words))
}
