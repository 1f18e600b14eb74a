//! What there is to choose from: settings, profiles, printers.

use std::sync::{Arc, OnceLock};

use axum::body::Body;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::body::whole;
use super::description::Common;
use super::error::{ApiError, ErrorKind};
use super::extract::{Json, Path, Query};
use super::printers::Printer;
use super::shared::Shared;
use crate::job::ObjectSettings;
use crate::options::{Field, Kind};
use crate::presets::{self, PresetError};
use crate::profile::{self, EMBEDDED, SECTIONS, Settings};

/// The routes.
pub fn router(shared: Arc<Shared>) -> OpenApiRouter {
    OpenApiRouter::new()
        .routes(routes!(schema))
        .routes(routes!(profiles))
        .routes(routes!(convert))
        .routes(routes!(printers))
        .routes(routes!(printer))
        .with_state(shared)
}

/// Every setting.
#[derive(Clone, Debug, Serialize, ToSchema)]
struct Schema {
    /// In the order of the documentation.
    groups: Vec<Group>,
}

/// Settings that belong together.
#[derive(Clone, Debug, Serialize, ToSchema)]
struct Group {
    /// The part of the keys before the dot.
    name: &'static str,
    /// The same for people.
    title: String,
    /// What they are about.
    help: String,
    /// The settings.
    settings: Vec<Setting>,
}

/// A setting.
#[derive(Clone, Debug, Serialize, ToSchema)]
struct Setting {
    /// Dotted key.
    key: String,
    /// Meaning.
    help: &'static str,
    /// What it takes.
    kind: SettingKind,
    /// Unit of its numbers.
    #[serde(skip_serializing_if = "str::is_empty")]
    unit: &'static str,
    /// Least value.
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<f64>,
    /// Greatest value.
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<f64>,
    /// Words that it takes.
    #[serde(skip_serializing_if = "Option::is_none")]
    choices: Option<&'static [&'static str]>,
    /// How many numbers a list has; none: any number.
    #[serde(skip_serializing_if = "Option::is_none")]
    count: Option<usize>,
    /// Value of the default profile.
    default: Value,
    /// Whether a model may have a value of its own.
    per_object: bool,
}

/// What a setting takes.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum SettingKind {
    /// A number.
    Number,
    /// A whole number.
    Integer,
    /// True or false.
    Boolean,
    /// One of a few words.
    Choice,
    /// Any text.
    Text,
    /// Numbers.
    List,
    /// A share: `0.15` or `15%`.
    Percent,
}

/// All settings
///
/// Keys with their meaning, range, unit and default, made from the same table as the reference.
#[utoipa::path(
    get, path = "/v1/schema", tag = "catalog",
    responses((status = 200, description = "all settings", body = Schema), Common)
)]
async fn schema() -> Json<&'static Schema> {
    static SCHEMA: OnceLock<Schema> = OnceLock::new();
    Json(SCHEMA.get_or_init(|| {
        let defaults = serde_json::to_value(Settings::default()).unwrap_or_default();
        let groups = SECTIONS.iter().map(|section| Group {
            name: section.name,
            title: title(section.name),
            help: section.doc.trim().trim_start_matches(&format!("`[{}]`:", section.name)).trim().to_owned(),
            settings: section.fields.iter().map(|field| setting(section.name, field, &defaults)).collect(),
        });
        Schema { groups: groups.collect() }
    }))
}

fn setting(section: &str, field: &Field, defaults: &Value) -> Setting {
    let (kind, choices, count) = match field.kind {
        Kind::Number => (SettingKind::Number, None, None),
        Kind::Count => (SettingKind::Integer, None, None),
        Kind::Share => (SettingKind::Percent, None, None),
        Kind::Flag => (SettingKind::Boolean, None, None),
        Kind::Text => (SettingKind::Text, None, None),
        Kind::Choice(words) => (SettingKind::Choice, Some(words), None),
        Kind::Numbers(count) => (SettingKind::List, None, Some(count)),
        Kind::List => (SettingKind::List, None, None),
    };
    Setting {
        key: format!("{section}.{}", field.name),
        help: field.doc.trim(),
        kind,
        unit: field.unit,
        min: field.range.map(|range| range.0),
        max: field.range.map(|range| range.1),
        choices,
        count,
        default: defaults[section][field.name].clone(),
        per_object: ObjectSettings::SECTIONS.contains(&section),
    }
}

/// `first_layer` as `First layer`.
fn title(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters.next().map(|first| first.to_uppercase().collect::<String>()).unwrap_or_default();
    (first + letters.as_str()).replace('_', " ")
}

/// A built-in profile.
#[derive(Debug, Serialize, ToSchema)]
struct Profile {
    /// By which it is chosen.
    name: &'static str,
    /// `printer`, `material`, `quality`, or `job` for all three.
    kind: &'static str,
    /// A line about it.
    help: String,
}

/// Built-in profiles
#[utoipa::path(
    get, path = "/v1/profiles", tag = "catalog",
    responses((status = 200, description = "the built-in profiles", body = [Profile]), Common)
)]
async fn profiles() -> Json<Vec<Profile>> {
    let profiles = EMBEDDED.iter().map(|profile| Profile {
        name: profile.name,
        kind: profile.kind.name(),
        help: profile.description(),
    });
    Json(profiles.collect())
}

/// What a configuration is called.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Named {
    /// Name of its file.
    name: String,
}

/// Another slicer's configuration as a profile
///
/// What `pathwright profiles show` prints of an `.ini` file: a profile (TOML) with where each value comes from, and what is
/// not taken over.
#[utoipa::path(
    post, path = "/v1/profiles/convert", tag = "catalog", params(Named),
    request_body(content = String, content_type = "text/plain"),
    responses(
        (status = 200, description = "the profile", body = String, content_type = "application/toml"),
        (status = 422, description = "it is no configuration", body = super::error::ErrorBody),
        Common
    )
)]
async fn convert(Query(named): Query<Named>, body: Body) -> Result<Response, ApiError> {
    let text = String::from_utf8_lossy(&whole(body).await?).into_owned();
    let profile = aside(move || profile::converted(&named.name, &text)).await?;
    let profile = profile.map_err(|problem| ApiError::unusable(ErrorKind::Settings, problem))?;
    Ok(([(header::CONTENT_TYPE, "application/toml")], profile).into_response())
}

/// What to list.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Words {
    /// Words that a printer's name, file or slicer has, in any order.
    #[serde(default)]
    q: String,
    /// Most printers to list; without it 200.
    #[param(minimum = 1)]
    limit: Option<usize>,
}

/// Printers of other slicers' presets
#[utoipa::path(
    get, path = "/v1/printers", tag = "catalog", params(Words),
    responses((status = 200, description = "the printers that have the words", body = [Printer]), Common)
)]
async fn printers(
    State(shared): State<Arc<Shared>>,
    Query(words): Query<Words>,
) -> Result<Json<Vec<Printer>>, ApiError> {
    let most = words.limit.unwrap_or(200);
    if most == 0 {
        return Err(ApiError::usage("limit: 1 or more are possible"));
    }
    let words: Vec<String> = words.q.split_whitespace().map(str::to_lowercase).collect();
    let list = move || {
        let printers = shared.printers.of(&shared.presets).iter();
        printers.filter(|printer| printer.has(&words)).take(most).cloned().collect()
    };
    Ok(Json(aside(list).await?))
}

/// What goes with a printer.
#[derive(Debug, Serialize, ToSchema)]
struct PrinterPresets {
    /// The printer.
    printer: Printer,
    /// Print presets that fit.
    prints: Vec<String>,
    /// Filament presets that fit it and the print preset.
    filaments: Vec<String>,
    /// The print preset that is taken where none is named.
    default_print: String,
    /// The filament preset that is taken where none is named.
    default_filament: String,
    /// What is to be known of the choice.
    notes: Vec<String>,
}

/// The choice to show.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Choice {
    /// Print preset whose filaments are wanted; without it, the printer's own choice.
    print: Option<String>,
}

/// A printer with the presets that fit it
#[utoipa::path(
    get, path = "/v1/printers/{name}", tag = "catalog",
    params(("name" = String, Path, description = "as `/v1/printers` lists it"), Choice),
    responses(
        (status = 200, description = "the presets that fit", body = PrinterPresets),
        (status = 404, description = "there is no such printer", body = super::error::ErrorBody),
        (status = 422, description = "its presets do not resolve", body = super::error::ErrorBody),
        Common
    )
)]
async fn printer(
    State(shared): State<Arc<Shared>>,
    Path(name): Path<String>,
    Query(choice): Query<Choice>,
) -> Result<Json<PrinterPresets>, ApiError> {
    let find = move || {
        let library = &shared.presets;
        library.preset(presets::Kind::Printer, &name).map_err(ApiError::not_found)?;
        let unusable = |error: PresetError| ApiError::unusable(ErrorKind::Settings, error);
        let chosen = library.choose(&name, choice.print.as_deref(), None).map_err(unusable)?;
        Ok(PrinterPresets {
            printer: Printer::of(library, &chosen.printer),
            prints: chosen.prints,
            filaments: chosen.filaments,
            default_print: chosen.print.name,
            default_filament: chosen.filament.name,
            notes: chosen.notes,
        })
    };
    aside(find).await?.map(Json)
}

/// Does something that takes a while, not on the threads that answer.
async fn aside<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, ApiError> {
    tokio::task::spawn_blocking(work).await.map_err(ApiError::internal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_for_people() {
        assert_eq!(title("first_layer"), "First layer");
    }
}
