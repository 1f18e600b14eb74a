//! Figures for Prometheus.

use std::fmt;
use std::time::Duration;

use axum::http::StatusCode;
use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::{Registry, Unit};

/// Figures for Prometheus.
pub struct Metrics {
    registry: Registry,
    requests: Family<RequestLabels, Counter>,
    seconds: Histogram,
    streams: Gauge,
    /// Jobs that were accepted.
    pub accepted: Counter,
    /// Those of them whose result was there already.
    pub known: Counter,
    /// Runs that began.
    pub begun: Counter,
    /// Runs that ended, by outcome.
    pub ended: Family<OutcomeLabels, Counter>,
    /// How long runs took.
    pub run_seconds: Histogram,
    /// Jobs that wait.
    pub waiting: Gauge,
    /// Jobs that run.
    pub running: Gauge,
    /// Bytes of results on the disk.
    pub kept_bytes: Gauge,
}

impl fmt::Debug for Metrics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Metrics").finish_non_exhaustive()
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
struct RequestLabels {
    method: String,
    path: String,
    status: u32,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
pub struct OutcomeLabels {
    /// `done`, `failed` or `cancelled`.
    pub outcome: &'static str,
}

impl Default for Metrics {
    fn default() -> Self {
        let mut registry = Registry::with_prefix("pathwright");
        let seconds = Histogram::new([0.001, 0.005, 0.02, 0.1, 0.5, 2.0, 10.0, 60.0]);
        let run_seconds = Histogram::new([0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0]);
        let metrics = Self {
            requests: Family::default(),
            seconds,
            streams: Gauge::default(),
            accepted: Counter::default(),
            known: Counter::default(),
            begun: Counter::default(),
            ended: Family::default(),
            run_seconds,
            waiting: Gauge::default(),
            running: Gauge::default(),
            kept_bytes: Gauge::default(),
            registry: Registry::default(),
        };
        registry.register("requests", "Requests that were answered", metrics.requests.clone());
        let help = "Time until the head of the answer";
        registry.register_with_unit("request", help, Unit::Seconds, metrics.seconds.clone());
        registry.register("event_streams", "Event streams that are open", metrics.streams.clone());
        registry.register("jobs_accepted", "Jobs that were accepted", metrics.accepted.clone());
        let help = "Jobs whose result was there, or under way, when they came";
        registry.register("jobs_known", help, metrics.known.clone());
        registry.register("runs_begun", "Slicing runs that began", metrics.begun.clone());
        registry.register("runs_ended", "Slicing runs that ended", metrics.ended.clone());
        let help = "Time that slicing runs took";
        registry.register_with_unit("run", help, Unit::Seconds, metrics.run_seconds.clone());
        registry.register("runs_waiting", "Slicing runs that wait", metrics.waiting.clone());
        registry.register("runs_running", "Slicing runs under way", metrics.running.clone());
        let help = "What results take on the disk";
        registry.register_with_unit("kept", help, Unit::Bytes, metrics.kept_bytes.clone());
        let version: Family<Vec<(&str, &str)>, Gauge<i64>> = Family::default();
        version.get_or_create(&vec![("version", env!("CARGO_PKG_VERSION"))]).set(1);
        registry.register("build_info", "The version of the program", version);
        Self { registry, ..metrics }
    }
}

impl Metrics {
    /// Counts a request; `None` is a method or a path that there is not.
    pub fn answered(&self, method: Option<&str>, path: Option<String>, status: StatusCode, took: Duration) {
        let labels = RequestLabels {
            method: method.unwrap_or("other").to_owned(),
            path: path.unwrap_or_else(|| "other".into()),
            status: u32::from(status.as_u16()),
        };
        self.requests.get_or_create(&labels).inc();
        self.seconds.observe(took.as_secs_f64());
    }

    /// All figures, in the text format of OpenMetrics.
    ///
    /// # Errors
    /// None that is known.
    pub fn text(&self, streams: usize) -> Result<String, fmt::Error> {
        self.streams.set(i64::try_from(streams).unwrap_or(i64::MAX));
        let mut text = String::new();
        encode(&mut text, &self.registry)?;
        Ok(text)
    }
}
