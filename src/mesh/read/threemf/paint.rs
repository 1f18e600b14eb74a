//! What PrusaSlicer, Bambu Studio and OrcaSlicer write to a triangle that is painted: hexadecimal digits, read from the last to the
//! first, each a part of the triangle. Of its lower two bits is how many sides are divided in halves; not 0: the upper two say which
//! one (of two which one is not), and the parts follow, the last of them first. 0: the upper two are the paint; 3 of them: it is 3
//! more than the next digit says, and if that is 15, 18 more than the one after it.

use crate::mesh::{Paint, PaintedFacet, Wish};

/// Parts are not divided deeper: a facet of 10 m is then finer than anything that is printed.
const DEEPEST: usize = 40;

/// What a triangle may have painted on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Tools,
    Seams,
    Supports,
}

impl Kind {
    /// The kind that an attribute of a triangle holds, whatever its prefix.
    pub fn of(key: &str) -> Option<Self> {
        match key.rsplit(':').next().unwrap_or_default() {
            "mmu_segmentation" | "paint_color" => Some(Self::Tools),
            "custom_seam" | "paint_seam" => Some(Self::Seams),
            "custom_supports" | "paint_supports" => Some(Self::Supports),
            _ => None,
        }
    }

    /// Adds what is painted on a triangle.
    ///
    /// # Errors
    /// What is wrong with the digits.
    pub fn read(self, digits: &str, triangle: [[f64; 3]; 3], paint: &mut Paint) -> Result<(), String> {
        let wrong = |problem| format!("`{}` is no paint: {problem}", shortened(digits));
        match self {
            Self::Tools => parts(digits, triangle, |corners, state| {
                paint.tools.push(PaintedFacet { corners, paint: state });
                Ok(())
            }),
            Self::Seams => wishes(digits, triangle, &mut paint.seams),
            Self::Supports => wishes(digits, triangle, &mut paint.supports),
        }
        .map_err(wrong)
    }
}

fn wishes(
    digits: &str,
    triangle: [[f64; 3]; 3],
    into: &mut Vec<PaintedFacet<Wish>>,
) -> Result<(), &'static str> {
    parts(digits, triangle, |corners, state| {
        let paint = match state {
            1 => Wish::Enforced,
            2 => Wish::Blocked,
            _ => return Err("only 1 and 2 mean something here"),
        };
        into.push(PaintedFacet { corners, paint });
        Ok(())
    })
}

/// Gives every part that is painted.
fn parts(
    digits: &str,
    triangle: [[f64; 3]; 3],
    mut give: impl FnMut([[f64; 3]; 3], u8) -> Result<(), &'static str>,
) -> Result<(), &'static str> {
    let mut left = digits.trim().chars().rev();
    let mut next = || {
        let digit = left.next().ok_or("it ends early")?;
        digit.to_digit(16).ok_or("digits are 0 to 9 and A to F")
    };
    let mut open = vec![(triangle, 0)];
    while let Some((corners, depth)) = open.pop() {
        let code = next()?;
        let (divided, upper) = (code & 3, code >> 2);
        if divided == 0 {
            let state = match upper {
                3 => match next()? {
                    15 => next()? + 18,
                    more => more + 3,
                },
                state => state,
            };
            if state > 0 {
                give(corners, state as u8)?;
            }
            continue;
        }
        if depth == DEEPEST {
            return Err("its parts are too small");
        }
        if upper == 3 {
            return Err("a triangle has three sides");
        }
        // The last part is the next to be read.
        open.extend(divide(corners, divided, upper as usize).map(|part| (part, depth + 1)));
    }
    match left.next() {
        Some(_) => Err("it goes on behind its end"),
        None => Ok(()),
    }
}

/// The parts of a triangle of which so many sides are halved.
fn divide(corners: [[f64; 3]; 3], sides: u32, side: usize) -> impl Iterator<Item = [[f64; 3]; 3]> {
    let [a, b, c] = [0, 1, 2].map(|k| corners[(k + if sides == 3 { 0 } else { side }) % 3]);
    let half = |p: [f64; 3], q: [f64; 3]| [0, 1, 2].map(|i| (p[i] + q[i]) / 2.0);
    let (ab, bc, ca) = (half(a, b), half(b, c), half(c, a));
    let parts = match sides {
        1 => [Some([a, b, bc]), Some([bc, c, a]), None, None],
        2 => [Some([a, ab, ca]), Some([ab, b, ca]), Some([b, c, ca]), None],
        _ => [Some([a, ab, ca]), Some([ab, b, bc]), Some([bc, c, ca]), Some([ab, bc, ca])],
    };
    parts.into_iter().flatten()
}

fn shortened(digits: &str) -> String {
    match digits.char_indices().nth(24) {
        Some((at, _)) => format!("{}…", &digits[..at]),
        None => digits.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    fn tools(digits: &str) -> Result<Vec<PaintedFacet<u8>>, String> {
        let mut paint = Paint::default();
        Kind::Tools.read(digits, TRIANGLE, &mut paint).map(|()| paint.tools)
    }

    fn area(corners: [[f64; 3]; 3]) -> f64 {
        let [a, b, c] = corners;
        ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
    }

    #[test]
    fn every_tool_has_its_digits() {
        let codes =
            [("4", 1), ("8", 2), ("0C", 3), ("1C", 4), ("DC", 16), ("EC", 17), ("0FC", 18), ("EFC", 32)];
        for (digits, tool) in codes {
            assert_eq!(tools(digits).unwrap(), [PaintedFacet { corners: TRIANGLE, paint: tool }]);
        }
        assert_eq!(tools("0").unwrap(), []);
    }

    #[test]
    fn parts_come_last_first_and_cover_the_triangle() {
        // Three sides halved: the middle is tool 2, the corners 0, 1 and 3.
        let found = tools("0480C83").unwrap_err();
        assert!(found.contains("behind its end"), "{found}");
        let found = tools("0C4083").unwrap();
        assert_eq!(found.iter().map(|part| part.paint).collect::<Vec<_>>(), [2, 1, 3]);
        assert_eq!(found[0].corners, [[2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]]);
        assert_eq!(found[2].corners[0], TRIANGLE[0]);
        for divided in ["441", "445", "449", "4442", "4446", "444A", "44443", "4444341"] {
            let found = tools(divided).unwrap();
            assert!(found.iter().all(|part| area(part.corners) > 0.0), "{divided}");
            assert_eq!(found.iter().map(|part| area(part.corners)).sum::<f64>(), 8.0, "{divided}");
        }
    }

    #[test]
    fn of_one_side_the_opposite_corner_is_named_and_of_two_the_one_between() {
        let shared = |digits: &str, corner: usize| {
            tools(digits).unwrap().iter().filter(|part| part.corners.contains(&TRIANGLE[corner])).count()
        };
        assert_eq!([0, 1, 2].map(|corner| shared("445", corner)), [1, 2, 1]);
        assert_eq!([0, 1, 2].map(|corner| shared("444A", corner)), [2, 1, 1]);
    }

    #[test]
    fn what_is_no_paint_is_told() {
        for (digits, problem) in [
            ("43", "ends early"),
            ("G", "0 to 9"),
            ("44D", "three sides"),
            ("C", "ends early"),
            ("", "ends early"),
        ] {
            let said = tools(digits).unwrap_err();
            assert!(said.contains(problem), "{said}");
        }
        let deep = "4".repeat(200) + &"1".repeat(199);
        assert!(tools(&deep).unwrap_err().contains("too small"));
        let mut paint = Paint::default();
        let said = Kind::Seams.read("0C", TRIANGLE, &mut paint).unwrap_err();
        assert!(said.contains("only 1 and 2"), "{said}");
    }
}
