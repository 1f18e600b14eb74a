//! Faces with more than three corners.

/// Splits a face into facets of its corners: a convex one around its first corner, any other as it looks from its front.
pub(super) fn split(corners: &[[f32; 3]], facets: &mut Vec<[u32; 3]>) {
    facets.clear();
    if corners.len() > 3 {
        let flat = from_front(corners);
        if !is_convex(&flat) {
            *facets = geometry::triangles(&flat);
        }
    }
    if facets.is_empty() {
        facets.extend((2..corners.len() as u32).map(|last| [0, last - 1, last]));
    }
}

/// What is said of faces, or facets, that were split.
pub(super) fn note(count: usize, one: &str) -> String {
    match count {
        1 => format!("1 {one} with more than 3 corners was split"),
        _ => format!("{count} {one}s with more than 3 corners were split"),
    }
}

/// A face without the coordinate that varies least on it, counter-clockwise.
fn from_front(corners: &[[f32; 3]]) -> Vec<[f64; 2]> {
    let seen = |[i, j]: [usize; 2]| corners.iter().map(move |c| [f64::from(c[i]), f64::from(c[j])]);
    let views = [[1, 2], [2, 0], [0, 1]];
    let areas = views.map(|view| {
        let [first, last] = [seen(view).next(), seen(view).next_back()].map(Option::unwrap_or_default);
        let from = |[x, y]: [f64; 2]| [x - first[0], y - first[1]];
        let sides = std::iter::once(last).chain(seen(view)).map(from).zip(seen(view).map(from));
        sides.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
    });
    let widest = (1..3).fold(0, |best, i| if areas[i].abs() > areas[best].abs() { i } else { best });
    let [i, j] = views[widest];
    seen(if areas[widest] < 0.0 { [j, i] } else { [i, j] }).collect()
}

/// Whether a counter-clockwise outline turns right nowhere.
fn is_convex(corners: &[[f64; 2]]) -> bool {
    let count = corners.len();
    (0..count).all(|i| {
        let [a, b, c] = [0, 1, 2].map(|step| corners[(i + step) % count]);
        (b[0] - a[0]) * (c[1] - b[1]) >= (b[1] - a[1]) * (c[0] - b[0])
    })
}
