//! Transforms of a 3MF file.

/// Rows applied from the left: a point p becomes (p, 1) · m, as the 3MF core specification (section 3.3) has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Affine(pub [[f64; 3]; 4]);

impl Affine {
    pub const NONE: Self = Self::scaled(1.0);

    /// Enlarges by a factor.
    pub const fn scaled(by: f64) -> Self {
        Self([[by, 0.0, 0.0], [0.0, by, 0.0], [0.0, 0.0, by], [0.0; 3]])
    }

    /// Reads twelve numbers, row by row, the last row in units of `unit_mm`. `None`: they are not twelve finite ones, or flatten.
    pub fn parse(text: &str, unit_mm: f64) -> Option<Self> {
        let numbers: Vec<f64> =
            text.split_ascii_whitespace().map(str::parse).collect::<Result<_, _>>().ok()?;
        let mut rows = [[0.0; 3]; 4];
        let [a, b, c, d] = &mut rows;
        for (row, values) in [a, b, c].into_iter().zip(numbers.as_chunks::<3>().0) {
            *row = *values;
        }
        *d = numbers.get(9..12)?.iter().map(|x| x * unit_mm).collect::<Vec<_>>().try_into().ok()?;
        let affine = Self(rows);
        let usable =
            numbers.len() == 12 && numbers.iter().all(|x| x.is_finite()) && affine.determinant().is_normal();
        usable.then_some(affine)
    }

    pub fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        let [a, b, c, d] = &self.0;
        [0, 1, 2].map(|i| p[0] * a[i] + p[1] * b[i] + p[2] * c[i] + d[i])
    }

    /// First this, then another.
    pub fn then(&self, next: &Self) -> Self {
        let [a, b, c, d] = self.0;
        let turned = |row: [f64; 3]| {
            let [x, y, z, _] = &next.0;
            [0, 1, 2].map(|i| row[0] * x[i] + row[1] * y[i] + row[2] * z[i])
        };
        Self([turned(a), turned(b), turned(c), next.apply(d)])
    }

    /// The same without its shift, and the shift.
    pub fn split(&self) -> (Self, [f64; 3]) {
        let [a, b, c, shift] = self.0;
        (Self([a, b, c, [0.0; 3]]), shift)
    }

    /// How much longer it makes what lies along an axis, at most.
    pub fn stretch(&self) -> f64 {
        let [a, b, c, _] = &self.0;
        [a, b, c].map(|row| row.iter().map(|x| x * x).sum::<f64>().sqrt()).into_iter().fold(0.0, f64::max)
    }

    /// Negative where it mirrors.
    pub fn determinant(&self) -> f64 {
        let [a, b, c, _] = self.0;
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_follow_one_another() {
        let turn = Affine::parse("0 1 0 -1 0 0 0 0 1 5 0 0", 10.0).expect("twelve numbers");
        assert_eq!(turn.apply([1.0, 0.0, 0.0]), [50.0, 1.0, 0.0]);
        let twice = turn.then(&turn);
        assert_eq!(twice.apply([1.0, 2.0, 3.0]), turn.apply(turn.apply([1.0, 2.0, 3.0])));
        assert!(Affine::parse("1 0 0 0 1 0 0 0 0 0 0 0", 1.0).is_none(), "it flattens");
        assert!(Affine::parse("1 0 0 0 1 0 0 0 1 0 0", 1.0).is_none());
    }
}
