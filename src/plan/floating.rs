//! What of a print begins in mid-air.

use crate::job::{CheckError, InputError, JobError};
use crate::profile::Settings;
use crate::toolpath::{LayerPaths, Role};

use super::contact::meets;
use super::sections::Sections;
use super::thin::ThinParts;
use crate::parallel::Workers;

/// Follows the layers from the bed up: nothing may begin in mid-air.
pub(crate) struct Floating<'a> {
    sections: &'a Sections,
    names: Vec<String>,
    layout: bool,
    /// Whether it is let pass.
    allowed: bool,
    /// For each object whether it was printed in the layer below, and the top of the last one where it was.
    below: Vec<bool>,
    last_mm: Vec<Option<f64>>,
    next: usize,
    thin: ThinParts,
    pub warnings: Vec<String>,
}

impl<'a> Floating<'a> {
    /// Nothing is printed yet. `names` are those of the sections' objects; `layout` tells whether they are where a file
    /// places them relative to others.
    pub fn new(sections: &'a Sections, names: Vec<String>, layout: bool, allowed: bool) -> Self {
        let count = names.len();
        Self {
            sections,
            names,
            layout,
            allowed,
            below: vec![false; count],
            last_mm: vec![None; count],
            next: 0,
            thin: ThinParts::default(),
            warnings: Vec::new(),
        }
    }

    /// Adds the next layer.
    ///
    /// # Errors
    /// An object that begins, or continues after a gap, where nothing is beneath it.
    pub fn take(&mut self, layer: &LayerPaths) -> Result<(), JobError> {
        let index = self.next;
        self.next += 1;
        self.thin.take(layer);
        let printed = self.printed(layer);
        for object in (0..printed.len()).filter(|&object| printed[object]) {
            let begins = !self.below[object] && index > self.sections.first_layer();
            if begins && !self.rests(object, index) {
                let error = self.in_mid_air(object, index);
                if !self.allowed {
                    return Err(error.into());
                }
                self.warnings.push(error.to_string());
            }
            self.last_mm[object] = Some(layer.top_mm);
        }
        self.below = printed;
        Ok(())
    }

    /// Ends after the last layer: warns of objects without any printed path, and of parts of others.
    ///
    /// # Errors
    /// Nothing was printed of any.
    pub fn finish(&mut self, hints: &[String]) -> Result<(), JobError> {
        let has_section = |object: usize| (0..self.next).any(|i| !self.sections.of(object, i).is_empty());
        let lost: Vec<usize> =
            (0..self.names.len()).filter(|&o| self.last_mm[o].is_none() && has_section(o)).collect();
        if let Some(&first) = lost.first().filter(|_| self.last_mm.iter().all(Option::is_none)) {
            return Err(
                InputError::TooThin { object: self.names[first].clone(), hints: hints.to_vec() }.into()
            );
        }
        if lost.is_empty() {
            self.warnings.extend(self.thin.warning());
        }
        let names = lost.into_iter().map(|object| &self.names[object]);
        self.warnings.extend(names.map(|name| format!("{name}: it is too thin to be printed anywhere")));
        Ok(())
    }

    /// Which objects have paths in a layer.
    fn printed(&self, layer: &LayerPaths) -> Vec<bool> {
        let mut printed = vec![false; self.below.len()];
        let around = |role| matches!(role, Role::Skirt | Role::Brim | Role::Support | Role::SupportInterface);
        for path in layer.paths.iter().filter(|path| !around(path.role)) {
            let island = path.island.and_then(|island| layer.islands.get(island.index()));
            let object = island.map_or(0, |island| island.object);
            if let Some(printed) = self.sections.local(object as usize).and_then(|o| printed.get_mut(o)) {
                *printed = true;
            }
        }
        printed
    }

    /// Whether an object's section lies over something that was printed: another object, or support.
    fn rests(&self, object: usize, index: usize) -> bool {
        let section = self.sections.of(object, index);
        let others = (0..self.below.len()).filter(|&other| other != object && self.below[other]);
        others.map(|other| self.sections.of(other, index - 1)).any(|under| meets(section, under))
            || self.sections.supports_under(index).any(|under| meets(section, under))
    }

    fn in_mid_air(&self, object: usize, index: usize) -> CheckError {
        CheckError::InMidAir {
            object: self.names[object].clone(),
            layer: index,
            z_mm: self.sections.layers[index].span.bottom_mm,
            last_mm: self.last_mm[object],
            on_thin: (self.sections.first_layer()..index).any(|i| !self.sections.of(object, i).is_empty()),
            mend: match self.layout {
                true => {
                    "arrange the file's objects anew with --arrange, hold it with --set support.enabled=true"
                }
                false => "repair the model, hold it with --set support.enabled=true",
            },
            hints: Vec::new(),
        }
    }
}

/// Islands that begin in mid-air.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Islands {
    pub count: usize,
    /// Bottom of the lowest.
    pub lowest_mm: f64,
    /// Area in which they begin, all together.
    pub area_mm2: f64,
}

impl Islands {
    /// Finds parts with nothing beneath them. Parts of a section too thin to be printed do not count.
    pub fn find(sections: &Sections, settings: &Settings, workers: Workers<'_>) -> Self {
        let first = sections.first_layer();
        let thin_mm = settings.walls.min_feature.0;
        let count = sections.layers.len().saturating_sub(first + 1);
        let areas = workers.map(count, |i| sections.begun_in_air(first + 1 + i, thin_mm));
        let mut islands = Self::default();
        for (i, areas) in areas.iter().enumerate().filter(|(_, areas)| !areas.is_empty()) {
            if islands.count == 0 {
                islands.lowest_mm = sections.layers[first + 1 + i].span.bottom_mm;
            }
            islands.count += areas.len();
            islands.area_mm2 += areas.iter().sum::<f64>();
        }
        islands
    }

    /// The warning for the user; `None` if there are none.
    pub fn warning(&self) -> Option<String> {
        let Self { count, lowest_mm, area_mm2 } = self;
        let islands =
            if *count == 1 { "1 island begins".to_owned() } else { format!("{count} islands begin") };
        (*count > 0).then(|| {
            format!(
                "{islands} in mid-air ({area_mm2:.1} mm²), the lowest at Z {lowest_mm:.2}; hold them with --set \
                 support.enabled=true, or turn the model"
            )
        })
    }
}
