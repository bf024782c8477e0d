//! What is noted while a contact is under way.

use std::time::Instant;

use crate::contact::outcome::{Contact, LeftOut, Refinement, Timing};
use crate::contact::report::warning::{Warning, WarningKind};

/// Timings, omissions and warnings of a contact under way.
#[derive(Debug, Default)]
pub(crate) struct Report {
    pub timings: Vec<Timing>,
    pub left_out: Vec<LeftOut>,
    pub warnings: Vec<Warning>,
    /// Rounds in which gaps were taken anew at the deformed skin.
    pub linearizations: Vec<Refinement>,
    /// Whether gaps were taken anew at the deformed skin and none of the answers left smaller ones.
    pub is_unsettled: bool,
}

impl Report {
    /// Adds the time since `started` to a stage.
    pub fn clock(&mut self, stage: &'static str, started: Instant) {
        add_timings(&mut self.timings, &[Timing { stage, seconds: started.elapsed().as_secs_f64() }]);
    }

    pub fn leave_out(&mut self, what: &'static str, why: impl Into<String>) {
        self.left_out.push(LeftOut { what, why: why.into() });
    }

    pub fn warn(&mut self, kind: WarningKind, message: String) {
        self.warnings.push(Warning { kind, message });
    }
}

/// Adds seconds to those known, stage by stage.
pub(crate) fn add_timings(known: &mut Vec<Timing>, more: &[Timing]) {
    for timing in more {
        match known.iter_mut().find(|known| known.stage == timing.stage) {
            Some(known) => known.seconds += timing.seconds,
            None => known.push(timing.clone()),
        }
    }
}

impl Contact {
    /// Notes what was left out once the contact is solved.
    pub(crate) fn leave_out(&mut self, what: &'static str, why: impl Into<String>) {
        self.left_out.push(LeftOut { what, why: why.into() });
    }

    pub(crate) fn warn(&mut self, kind: WarningKind, message: String) {
        self.warnings.push(Warning { kind, message });
    }
}
