//! The pipeline: gaps, candidates, response, complementarity, deformed skin, outcome.
