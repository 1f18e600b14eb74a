//! How long paths take, before their moves are planned.

use super::MotionSettings;
use super::overhang::Grade;
use super::rules::Rules;
use crate::toolpath::Path;

/// How long paths of a layer take at the speeds of their roles, seconds: less than they will, as nothing is accelerated and nothing
/// travelled.
pub(crate) fn least_s<'p>(
    paths: impl Iterator<Item = &'p Path>,
    layer: usize,
    settings: &MotionSettings,
) -> f64 {
    let of_path = |path: &Path| {
        let settings = path.tool.map_or(settings, |tool| settings.of_tool(tool));
        let closing = path.closed.then(|| [path.points[path.points.len() - 1], path.points[0]]);
        let segments = path.points.windows(2).map(|ends| [ends[0], ends[1]]).chain(closing);
        let length_mm: f64 = segments.map(|[a, b]| geometry::distance_mm(a.mm(), b.mm())).sum();
        length_mm / Rules::new(settings, layer).speed(path.role, Grade::Held, false).0
    };
    paths.map(of_path).sum()
}
