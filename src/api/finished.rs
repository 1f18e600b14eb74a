//! Finished G-code, of any slicer, as text or binary.

use crate::check::{self as checking, CheckReport, Survey};
use crate::estimate::{Firmware, Machine};
use crate::gcode::{Timetable, open_bytes};
use crate::job::{InputError, JobError, ReorderJob};
use crate::mesh::Mesh;
use crate::observer::Observer;
use crate::output::Output;
use crate::pipeline::Pipeline;
use crate::profile::Settings;
use crate::report::{PrintTime, Reordered};

/// Reorders G-code for less travel with the same print, as text; unchanged where nothing is gained.
///
/// # Errors
/// It is not understood, the result fails its proof, or the observer cancels the run.
///
/// # Examples
/// ```
/// use pathwright::{Observer, Settings, reorder};
///
/// let gcode = b"G28\nM83\nG1 X0 Y0 F3000\nG1 X9 Y0 E1\nG0 X0 Y2\nG1 X9 Y2 E1\n";
/// let (shorter, report) = reorder(gcode.to_vec(), &Settings::default(), &Observer::none())?;
/// assert!(report.after.travel_mm <= report.before.travel_mm && !shorter.is_empty());
/// # Ok::<(), pathwright::Error>(())
/// ```
pub fn reorder(
    gcode: Vec<u8>,
    settings: &Settings,
    observer: &Observer<'_>,
) -> Result<(Vec<u8>, Reordered), JobError> {
    let job = ReorderJob::default();
    let (reordered, report) = reorder_as(&gcode, &job, settings, observer)?;
    Ok((reordered.unwrap_or(gcode), report))
}

/// As [`reorder`], done as a job says, whose file does not count; `None` where nothing is gained.
///
/// # Errors
/// As [`reorder`].
pub fn reorder_as(
    gcode: &[u8],
    job: &ReorderJob,
    settings: &Settings,
    observer: &Observer<'_>,
) -> Result<(Option<Vec<u8>>, Reordered), JobError> {
    let mut output = Output::memory();
    let report = Pipeline::reorder_bytes(gcode, job, settings, &mut output, observer)?;
    Ok((report.changed.then(|| output.into_bytes()), report))
}

/// Finds the faults of G-code for a printer.
///
/// # Errors
/// There is no move in it.
///
/// # Examples
/// ```
/// use pathwright::{Settings, check};
///
/// let report = check(b"G28\nG1 X900 Y0 F3000\n", &Settings::default())?;
/// assert!(report.to_string().contains("outside"));
/// # Ok::<(), pathwright::Error>(())
/// ```
pub fn check(gcode: &[u8], settings: &Settings) -> Result<CheckReport, JobError> {
    checked(gcode, settings, None)
}

/// As [`check`], and sets the G-code beside what it should print: bodies that stand on z = 0, each with its name.
///
/// # Errors
/// As [`check`].
pub fn check_against(
    gcode: &[u8],
    bodies: &[(String, Mesh)],
    settings: &Settings,
) -> Result<CheckReport, JobError> {
    let mut survey = Survey::default();
    let mut report = checked(gcode, settings, Some(&mut survey))?;
    checking::against(bodies, &survey, || open_bytes(gcode), settings, &mut report).map_err(unreadable)?;
    Ok(report)
}

fn checked(gcode: &[u8], settings: &Settings, survey: Option<&mut Survey>) -> Result<CheckReport, JobError> {
    let input = open_bytes(gcode).map_err(unreadable)?;
    let report = checking::check(input, settings, survey).map_err(unreadable)?;
    report.ok_or_else(|| InputError::NoMoves.into())
}

/// The print time of G-code on the machine of the settings, by layer, role and activity.
///
/// # Errors
/// It cannot be read.
///
/// # Examples
/// ```
/// use pathwright::{Settings, time};
///
/// let time = time(b"G28\nG1 X150 Y0 F6000\n", &Settings::default())?;
/// assert!((time.total_s - 1.5).abs() < 0.1);
/// # Ok::<(), pathwright::Error>(())
/// ```
pub fn time(gcode: &[u8], settings: &Settings) -> Result<PrintTime, JobError> {
    let firmware = Firmware::from(settings.printer.flavor);
    let input = open_bytes(gcode).map_err(unreadable)?;
    let times = Timetable::read(input, &Machine::new(settings)).map_err(unreadable)?;
    Ok(PrintTime::new("G-code".into(), firmware, &times))
}

fn unreadable(source: std::io::Error) -> JobError {
    InputError::Gcode { source }.into()
}
