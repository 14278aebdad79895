//! Doubts about logs, to be checked before training.

use super::coordinate::{Coordinate, FirstOutlier};
use super::report::{Column, File, Report};

/// Largest plausible angle of a joint, rad.
const FAR: f64 = 60.0;

/// Fraction of time in motion below which most samples are uninformative about a coordinate.
const SELDOM: f64 = 0.05;

impl Report {
    /// All doubts in words, one of each kind.
    pub fn doubts(&self) -> Vec<String> {
        let columns =
            [far, still, missing].into_iter().filter_map(|doubt| self.columns.iter().find_map(doubt));
        let files = [backwards, repeated].into_iter().filter_map(|doubt| self.files.iter().find_map(doubt));
        let of_coordinates = [degrees, turns, one_way, seldom];
        let coordinates =
            of_coordinates.into_iter().filter_map(|doubt| self.coordinates.iter().find_map(doubt));
        let outliers = self.coordinates.iter().filter_map(outliers);
        columns.chain(files).chain(coordinates).chain(outliers).collect()
    }
}

fn far(it: &Column) -> Option<String> {
    let most = it.greatest.abs().max(it.least.abs());
    (it.is('q') && most > FAR && it.unit.is_none()).then(|| {
        let column = &it.column;
        format!(
            "{column} reaches {most:.4}; if it is in degrees or counts, give its unit under [data.columns]"
        )
    })
}

fn still(it: &Column) -> Option<String> {
    let doubt = || format!("{} does not move: nothing can be learned of it", it.column);
    (it.is('q') && it.greatest == it.least).then(doubt)
}

fn missing(it: &Column) -> Option<String> {
    let Column { column, missing, .. } = it;
    let doubt = || {
        format!(
            "{column} has {missing} cells without a number: blank cells of a CSV file are passed over, others are refused"
        )
    };
    (it.taken_for.is_some() && *missing > 0).then(doubt)
}

fn backwards(it: &File) -> Option<String> {
    let File { file, backwards, .. } = it;
    let file = file.display();
    (*backwards > 0)
        .then(|| format!("{file}: time goes back {backwards} times; sort the samples or cut the file there"))
}

fn repeated(it: &File) -> Option<String> {
    let File { file, repeated, .. } = it;
    let (file, stamps) = (file.display(), if *repeated == 1 { "stamp" } else { "stamps" });
    (*repeated > 0)
        .then(|| format!("{file}: {repeated} {stamps} repeated; the first sample of each is learned from"))
}

fn degrees(it: &Coordinate) -> Option<String> {
    let Coordinate { column, turns_of_360, .. } = it;
    (*turns_of_360 > 0)
        .then(|| format!("{column} jumps by 360 {turns_of_360} times, as degrees do; give unit = \"deg\""))
}

fn turns(it: &Coordinate) -> Option<String> {
    let Coordinate { column, turns, .. } = it;
    (*turns > 0).then(|| {
        format!("{column} jumps by 2π {turns} times; whole turns are added where the coordinate is an angle")
    })
}

fn one_way(it: &Coordinate) -> Option<String> {
    let Coordinate { column, reversals, .. } = it;
    let doubt = || format!("{column} never turns back: its Coulomb friction looks like a constant force");
    (*reversals == 0 && it.speed > 0.0).then(doubt)
}

fn seldom(it: &Coordinate) -> Option<String> {
    let Coordinate { column, moving, .. } = it;
    let doubt =
        || format!("{column} moves for {:.1}% of the time only: little can be learned of it", 100.0 * moving);
    (it.speed > 0.0 && *moving < SELDOM).then(doubt)
}

fn outliers(it: &Coordinate) -> Option<String> {
    let Coordinate { column, outliers, first_outlier, .. } = it;
    let FirstOutlier { file, sample, time, off } = first_outlier.as_ref()?;
    let (file, samples) = (file.display(), if *outliers == 1 { "sample" } else { "samples" });
    Some(format!(
        "{column} has {outliers} single {samples} apart from the neighbours, the first by {off:.3} at {time:.4} s (sample {sample}) of {file}; \
         training over windows counts such little, leave_out under [data] cuts out more of them"
    ))
}
