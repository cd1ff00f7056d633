//! Why a regression has no solution.

/// Why a regression has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum RegressionError {
    /// A row does not fit the columns, or holds a number that is not finite.
    #[error("row {row}: {columns} finite numbers, a finite response and a weight ≥ 0 expected")]
    Row {
        /// Number of the row, from 0.
        row: usize,
        /// Number of columns.
        columns: usize,
    },
    /// There are fewer rows than unknowns.
    #[error("{found} rows for {unknowns} unknowns")]
    TooFewRows {
        /// Rows with a positive weight.
        found: usize,
        /// Columns and intercepts.
        unknowns: usize,
    },
    /// A column is the same in every row of a group.
    #[error("`{column}` does not vary")]
    Constant {
        /// The column.
        column: String,
    },
    /// A column follows from others.
    #[error("`{column}` varies only together with {}", others.join(" and "))]
    Dependent {
        /// The column.
        column: String,
        /// The columns that it follows from.
        others: Vec<String>,
    },
    /// Intervals need several clusters.
    #[error("{found} clusters, at least {needed} needed to tell how far the result can be trusted")]
    TooFewClusters {
        /// Clusters found, in the way that has fewest.
        found: usize,
        /// Clusters needed.
        needed: usize,
    },
}
