//! What a regression is made of.

use super::error::RegressionError;

/// Rows of one regression. Every row has a value for each column, a response, a weight, a group and, for each
/// way in which errors may be shared, a cluster.
#[derive(Clone, Debug)]
pub(crate) struct Regression {
    pub(super) columns: Vec<String>,
    pub(super) intercepts: Intercepts,
    pub(super) design: Vec<f64>,
    pub(super) response: Vec<f64>,
    pub(super) weights: Vec<f64>,
    pub(super) groups: Vec<u32>,
    pub(super) clusters: Vec<Vec<u32>>,
}

/// Which constants the model has besides its columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Intercepts {
    /// None: the response is 0 where all columns are.
    None,
    /// One for each group.
    PerGroup,
}

/// One row of a regression.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<'a> {
    /// A value for each column.
    pub columns: &'a [f64],
    /// The value to be explained.
    pub response: f64,
    /// Prior weight, ≥ 0; proportional to 1/σ².
    pub weight: f64,
    /// Which intercept.
    pub group: u32,
    /// Which cluster, for each way in which errors may be shared; empty for independent errors.
    pub clusters: &'a [u32],
}

impl Regression {
    /// A regression on the named columns, without rows yet.
    #[must_use]
    pub(crate) fn new(columns: impl IntoIterator<Item = impl Into<String>>, intercepts: Intercepts) -> Self {
        Self {
            columns: columns.into_iter().map(Into::into).collect(),
            intercepts,
            design: Vec::new(),
            response: Vec::new(),
            weights: Vec::new(),
            groups: Vec::new(),
            clusters: Vec::new(),
        }
    }

    /// Adds a row. All rows name their clusters in the same ways, as the first row does.
    ///
    /// # Errors
    /// [`RegressionError::Row`] for a wrong number of values or clusters, or a number that is not finite.
    pub(crate) fn push(&mut self, row: Row<'_>) -> Result<(), RegressionError> {
        let number = self.response.len();
        if number == 0 {
            self.clusters = vec![Vec::new(); row.clusters.len()];
        }
        let finite = row.columns.iter().chain([&row.response, &row.weight]).all(|value| value.is_finite());
        let fits = row.columns.len() == self.columns.len() && row.clusters.len() == self.clusters.len();
        if !finite || !fits || row.weight < 0.0 {
            return Err(RegressionError::Row { row: number, columns: self.columns.len() });
        }
        self.design.extend_from_slice(row.columns);
        self.response.push(row.response);
        self.weights.push(row.weight);
        self.groups.push(row.group);
        self.clusters.iter_mut().zip(row.clusters).for_each(|(way, &cluster)| way.push(cluster));
        Ok(())
    }

    /// Number of rows.
    #[must_use]
    pub(crate) fn rows(&self) -> usize {
        self.response.len()
    }

    /// Rows with a weight, in groups of more than one such row: a row alone only determines its intercept.
    pub(super) fn entering(&self) -> Vec<bool> {
        let weighted = |row: usize| self.weights[row] > 0.0;
        if self.intercepts == Intercepts::None {
            return (0..self.rows()).map(weighted).collect();
        }
        let mut counts = std::collections::HashMap::new();
        (0..self.rows()).filter(|&row| weighted(row)).for_each(|row| {
            *counts.entry(self.groups[row]).or_insert(0usize) += 1;
        });
        (0..self.rows())
            .map(|row| weighted(row) && counts.get(&self.groups[row]).is_some_and(|&n| n > 1))
            .collect()
    }

    pub(super) fn group_count(&self, entering: &[bool]) -> usize {
        let entered = self.groups.iter().zip(entering).filter(|(_, enters)| **enters).map(|(group, _)| group);
        match self.intercepts {
            Intercepts::None => 0,
            Intercepts::PerGroup => entered.collect::<std::collections::HashSet<_>>().len(),
        }
    }
}
