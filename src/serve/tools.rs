//! Finished G-code: reordered, checked, timed, while the client waits.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use axum::Extension;
use axum::extract::{DefaultBodyLimit, Multipart, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::description::Common;
use super::error::{ApiError, ErrorBody};
use super::extract::{Form, Json, Query};
use super::jobs::{Jobs, Received, receive};
use super::names::disposition;
use super::tokens::Client;
use crate::api::{self, Model};
use crate::job::{JobError, Project};
use crate::mesh::Mesh;
use crate::observer::Observer;
use crate::profile::Settings;

/// Memory for each byte of G-code (9 were measured for reordering, 2 for the others), and for each of a model.
const PER_BYTE: u64 = 12;

/// The routes.
pub fn router(jobs: Arc<Jobs>) -> OpenApiRouter {
    OpenApiRouter::new()
        .routes(routes!(reorder))
        .routes(routes!(check))
        .routes(routes!(time))
        // Sizes are watched for all requests.
        .layer(DefaultBodyLimit::disable())
        .with_state(jobs)
}

/// The parts of a request with G-code.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "described, not made")]
struct GcodeForm {
    /// Printer and settings; models and placement in it do not count.
    #[schema(value_type = Project, required = false)]
    project: Option<Project>,
    /// G-code as text or binary.
    #[schema(value_type = String, format = Binary)]
    gcode: String,
}

/// The parts of a request to check G-code.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "described, not made")]
struct CheckForm {
    /// Printer and settings; models and placement in it do not count.
    #[schema(value_type = Project, required = false)]
    project: Option<Project>,
    /// G-code as text or binary.
    #[schema(value_type = String, format = Binary)]
    gcode: String,
    /// Models that it should print, at whatever position.
    #[schema(value_type = Vec<String>, format = Binary, required = false)]
    model: Vec<String>,
}

/// What is wanted of reordering.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Wanted {
    /// Whether to answer with what is saved instead of the file.
    #[serde(default)]
    report: bool,
}

/// Shorten the travel in finished G-code
///
/// The paths within each layer are reordered; everything else stays. The result is read back and compared layer by layer.
#[utoipa::path(
    post, path = "/v1/reorder", tag = "tools", params(Wanted),
    request_body(content = GcodeForm, content_type = "multipart/form-data"),
    responses(
        (status = 200, description = "the file, or with `report` what was saved", content((String = "text/x-gcode"), (Object = "application/json"))),
        Unusable, Common
    )
)]
async fn reorder(
    State(jobs): State<Arc<Jobs>>,
    Extension(_client): Extension<Client>,
    Query(wanted): Query<Wanted>,
    Form(form): Form<Multipart>,
) -> Result<Response, ApiError> {
    let (name, text, report) = with_gcode(&jobs, form, &["gcode"], |given, observer| {
        let (text, mut report) = api::reorder(given.gcode, &given.settings, observer)?;
        report.file.clone_from(&given.name);
        Ok((given.name, text, report))
    })
    .await?;
    if wanted.report {
        return Ok(Json(report).into_response());
    }
    let headers = [
        (header::CONTENT_TYPE, "text/x-gcode".to_owned()),
        (header::CONTENT_DISPOSITION, disposition(&name)),
    ];
    Ok((headers, text).into_response())
}

/// Find the faults of G-code
///
/// With models the print is also compared with them: missing islands, material outside, beads over air, volume.
#[utoipa::path(
    post, path = "/v1/check", tag = "tools",
    request_body(content = CheckForm, content_type = "multipart/form-data"),
    responses((status = 200, description = "the report, as `pathwright check --json` prints it", body = Object), Unusable, Common)
)]
async fn check(
    State(jobs): State<Arc<Jobs>>,
    Extension(_client): Extension<Client>,
    Form(form): Form<Multipart>,
) -> Result<Response, ApiError> {
    let report = with_gcode(&jobs, form, &["gcode", "model"], |given, _observer| {
        let mut report = match given.bodies.is_empty() {
            true => api::check(&given.gcode, &given.settings)?,
            false => api::check_against(&given.gcode, &given.bodies, &given.settings)?,
        };
        report.file = given.name;
        Ok(report)
    });
    Ok(Json(report.await?).into_response())
}

/// Estimate the print time of G-code
#[utoipa::path(
    post, path = "/v1/time", tag = "tools",
    request_body(content = GcodeForm, content_type = "multipart/form-data"),
    responses((status = 200, description = "the times, as `pathwright time --json` prints them", body = Object), Unusable, Common)
)]
async fn time(
    State(jobs): State<Arc<Jobs>>,
    Extension(_client): Extension<Client>,
    Form(form): Form<Multipart>,
) -> Result<Response, ApiError> {
    let time = with_gcode(&jobs, form, &["gcode"], |given, _observer| {
        let mut time = api::time(&given.gcode, &given.settings)?;
        time.file = given.name;
        Ok(time)
    });
    Ok(Json(time.await?).into_response())
}

/// Answers to G-code that is of no use.
#[derive(utoipa::IntoResponses)]
#[allow(dead_code, reason = "described, not made")]
enum Unusable {
    /// It is no G-code, or the settings are wrong.
    #[response(status = 422)]
    NoGcode(ErrorBody),
}

/// What a request brought.
struct Given {
    name: String,
    gcode: Vec<u8>,
    settings: Settings,
    bodies: Vec<(String, Mesh)>,
}

/// Sets a flag when the client goes away.
struct Leaving(Arc<AtomicBool>);

impl Drop for Leaving {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Reads a request and does something with it on the threads that slice, as long as the client waits and it may take.
async fn with_gcode<T: Send + 'static>(
    jobs: &Arc<Jobs>,
    form: Multipart,
    parts: &[&'static str],
    work: impl FnOnce(Given, &Observer<'_>) -> Result<T, JobError> + Send + 'static,
) -> Result<T, ApiError> {
    let upload = {
        let _turn = jobs.uploads.clone().acquire_owned().await.map_err(ApiError::internal)?;
        receive(form, parts, &jobs.files).await?
    };
    let need = upload.files.iter().map(|file| file.model.bytes * PER_BYTE).sum();
    let left = Arc::new(AtomicBool::new(false));
    let _leaving = Leaving(left.clone());
    let (owned, watched) = (jobs.clone(), left.clone());
    let share = jobs.blocking(move |jobs| {
        let share = jobs.budget.take(need, || !watched.load(Ordering::Relaxed) && !jobs.is_stopping());
        share.ok_or_else(|| ApiError::busy("the server is ending"))
    });
    let share = share.await?;
    let run = move || {
        let _share = share;
        let jobs = owned;
        let deadline = Instant::now() + jobs.shared.limits.job_time;
        let is_over = || left.load(Ordering::Relaxed) || jobs.is_stopping() || Instant::now() > deadline;
        let observer = Observer::none().cancelled_when(is_over);
        let project = upload.project.unwrap_or_default().by_length();
        let settings = project.resolve(Some(&jobs.shared.presets))?.settings;
        let given = given(upload.files, settings)?;
        work(given, &observer).map_err(|error| match error {
            JobError::Cancelled => {
                let most = jobs.shared.limits.job_time.as_secs();
                ApiError::busy(format!(
                    "it takes longer than {most} s (--max-job-time), or the server is ending"
                ))
            }
            error => error.into(),
        })
    };
    let mistake = || ApiError::internal("a mistake of this program");
    jobs.shared.in_pool(run).await.ok_or_else(mistake)?
}

fn given(files: Vec<Received>, settings: Settings) -> Result<Given, ApiError> {
    let (mut gcode, mut bodies) = (None, Vec::new());
    for file in files {
        let contents = std::fs::read(&file.path)?;
        match (file.part, &gcode) {
            ("gcode", None) => gcode = Some((file.model.name, contents)),
            ("gcode", Some(_)) => return Err(ApiError::usage("one file of G-code is taken at once")),
            _ => bodies.extend(Model::from_bytes(&file.model.name, &contents)?.standing_bodies(&settings)?),
        }
    }
    let (name, gcode) = gcode.ok_or_else(|| ApiError::usage("there is no G-code; send it as `gcode`"))?;
    Ok(Given { name, gcode, settings, bodies })
}
