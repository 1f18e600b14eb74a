//! Layers whose sparse infill is laid in one go, in beads as high as all of them.

use geometry::Region;

/// Neighbouring layers that are filled at the height of the last one.
#[derive(Clone, Debug)]
pub(super) struct Stack {
    /// Index of the lowest layer.
    pub(super) first: usize,
    /// Index of the highest layer.
    pub(super) last: usize,
    /// Height of all of them in millimetres.
    pub(super) height_mm: f64,
    /// Where all of them are sparse.
    pub(super) area: Region,
}

/// The stacks of a print, bottom up.
#[derive(Clone, Debug, Default)]
pub(super) struct Stacks {
    all: Vec<Stack>,
}

impl Stacks {
    /// Stacks of at most `most` layers that together are at most `highest_mm` high. `areas` are the heights of all layers
    /// and where they are sparse; the first layer is in no stack.
    pub(super) fn new(areas: &[(f64, Region)], most: usize, highest_mm: f64) -> Self {
        let mut all: Vec<Stack> = Vec::new();
        for (index, (height_mm, area)) in areas.iter().enumerate().skip(1) {
            let last = all.last_mut().filter(|stack| {
                let fits = stack.height_mm + height_mm <= highest_mm + 1e-6;
                stack.last + 1 == index && index - stack.first < most && fits
            });
            if let Some(stack) = last {
                let shared = geometry::intersection(&stack.area, area);
                if !shared.is_empty() {
                    (stack.last, stack.area) = (index, shared);
                    stack.height_mm += height_mm;
                    continue;
                }
            }
            if !area.is_empty() {
                all.push(Stack { first: index, last: index, height_mm: *height_mm, area: area.clone() });
            }
        }
        all.retain(|stack| stack.last > stack.first);
        Self { all }
    }

    /// The stack that a layer is in, and its number.
    pub(super) fn of(&self, layer: usize) -> Option<(&Stack, usize)> {
        let number = self.all.partition_point(|stack| stack.last < layer);
        self.all.get(number).filter(|stack| stack.first <= layer).map(|stack| (stack, number))
    }
}
