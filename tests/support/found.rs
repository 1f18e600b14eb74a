//! What `check` finds in a text.

use std::io::Cursor;

use pathwright::check::{self, CheckReport, Kind, Survey};
use pathwright::mesh::Mesh;
use pathwright::profile::Settings;

/// The report on a text alone.
pub fn report(text: impl AsRef<[u8]>, settings: &Settings) -> CheckReport {
    check::check(text.as_ref(), settings, None).expect("memory can be read").expect("there are moves")
}

/// The report on a text beside its model's bodies.
pub fn beside(text: impl AsRef<[u8]>, bodies: &[(String, Mesh)], settings: &Settings) -> CheckReport {
    let text = text.as_ref();
    let mut survey = Survey::default();
    let report = check::check(text, settings, Some(&mut survey)).expect("memory can be read");
    let mut report = report.expect("there are moves");
    check::against(bodies, &survey, || Ok(Cursor::new(text)), settings, &mut report).expect("read");
    report
}

pub fn kinds(report: &CheckReport) -> Vec<Kind> {
    report.faults.iter().map(|fault| fault.kind).collect()
}
