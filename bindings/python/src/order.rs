//! Polylines in, order out.

use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use ordering::{Cost, Effort, OrderOptions, Polyline, TravelTime, Watch, chosen};
use pathwright::geometry::Point;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::run::{go_on, run};
use super::task::strategy;

/// Order, entry, length, bound.
type Ordered<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, f64, Option<f64>);

/// Speed, acceleration, cruise ratio, stop, retraction from, retraction.
type Time = (f64, f64, f64, f64, f64, f64);

/// Orders polylines: their vertices one after the other, the first vertex of each and the number of all.
#[pyfunction]
#[pyo3(signature = (points, starts, closed, groups, start, strategy_name, effort, time, certify))]
#[allow(clippy::too_many_arguments, reason = "Python passes them one by one")]
pub fn order<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'py, f64>,
    starts: PyReadonlyArray1<'py, i64>,
    closed: PyReadonlyArray1<'py, bool>,
    groups: PyReadonlyArray1<'py, u32>,
    start: Option<(f64, f64)>,
    strategy_name: &str,
    effort: &str,
    time: Option<Time>,
    certify: bool,
) -> PyResult<Ordered<'py>> {
    let points: Vec<Point> =
        points.as_slice()?.chunks_exact(2).map(|xy| Point::from_mm(xy[0], xy[1])).collect();
    let (starts, closed, groups) =
        (starts.as_slice()?.to_vec(), closed.as_slice()?.to_vec(), groups.as_slice()?.to_vec());
    let mut options = OrderOptions::default();
    options.strategy = strategy(strategy_name)?;
    options.effort = chosen(Effort::ALL, "effort", effort).map_err(PyValueError::new_err)?;
    options.start = start.map(|(x, y)| Point::from_mm(x, y));
    options.certify = certify;
    if let Some((speed_mm_s, acceleration_mm_s2, cruise_ratio, stop_s, retract_from_mm, retract_s)) = time {
        options.cost = Cost::Time(TravelTime {
            speed_mm_s,
            acceleration_mm_s2,
            cruise_ratio,
            stop_s,
            retract_from_mm,
            retract_inside_from_mm: retract_from_mm,
            retract_s,
            climb_s: 0.0,
        });
    }
    let ordered = run(py, None, move |observer| {
        let polylines = starts.windows(2).zip(closed).zip(groups);
        let polylines: Vec<Polyline> = polylines
            .map(|((range, closed), group)| Polyline {
                points: points[range[0] as usize..range[1] as usize].to_vec(),
                closed,
                group,
            })
            .collect();
        ordering::order_watched(&polylines, &options, Watch::new(&|| go_on(observer)))
    })?;
    let order = ordered.sequence.iter().map(|visit| i64::from(visit.item)).collect();
    let entries = ordered.sequence.iter().map(|visit| i64::from(visit.entry)).collect();
    Ok((PyArray1::from_vec(py, order), PyArray1::from_vec(py, entries), ordered.length_mm, ordered.bound_mm))
}
