//! Columns of Parquet files.

use crate::lerobot_problem::LerobotProblem;
use parquet::basic::Compression;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Numbers of a column in any file, however small it is.
const MOST_ANYWAY: u64 = 1 << 24;
/// Further numbers per byte of the file: a column that hardly changes packs to a few bytes.
const MOST_PER_BYTE: u64 = 100;

/// Rows that are read at once.
const AT_ONCE: usize = 4096;

/// Trouble with a column.
enum Trouble {
    Parquet(ParquetError),
    Compression(String),
    NoColumn,
    /// A row that has another number of numbers.
    Width(usize),
    TooLong,
}

impl From<ParquetError> for Trouble {
    fn from(error: ParquetError) -> Self {
        Self::Parquet(error)
    }
}

/// The numbers of the feature `name` in a data file, `width` for each row; NaN where one is missing.
pub(super) fn read(
    folder: &Path,
    file: &str,
    (name, width): (&str, usize),
) -> Result<Vec<f64>, LerobotProblem> {
    let work = || whole(&folder.join(file), name, width);
    // The library asserts some of what a damaged file may violate; a refusal in words must not depend on which.
    let read = catch_unwind(AssertUnwindSafe(work));
    let damaged = || Err(Trouble::Parquet(ParquetError::General("it is damaged".to_owned())));
    let file = file.to_owned();
    read.unwrap_or_else(|_| damaged()).map_err(|trouble| match trouble {
        Trouble::Parquet(error) => LerobotProblem::NotParquet { file, reason: error.to_string() },
        Trouble::Compression(codec) => LerobotProblem::Compression { file, codec },
        Trouble::NoColumn => LerobotProblem::NoColumn { file, name: name.to_owned() },
        Trouble::Width(row) => LerobotProblem::Width { file, row, width },
        Trouble::TooLong => {
            let reason = format!("its column {name:?} has more numbers than are read of a file of its size");
            LerobotProblem::NotParquet { file, reason }
        }
    })
}

fn whole(path: &Path, name: &str, width: usize) -> Result<Vec<f64>, Trouble> {
    let file = File::open(path).map_err(ParquetError::from)?;
    let bytes = file.metadata().map_err(ParquetError::from)?.len();
    let reader = SerializedFileReader::new(file)?;
    let mut column = Numbers { width, values: Vec::new(), most: most(bytes) };
    for group in 0..reader.num_row_groups() {
        column.take(&*reader.get_row_group(group)?, name)?;
    }
    match column.values.len() % width {
        0 => Ok(column.values),
        _ => Err(Trouble::Width(column.values.len() / width)),
    }
}

fn most(bytes: u64) -> u64 {
    MOST_PER_BYTE.saturating_mul(bytes).saturating_add(MOST_ANYWAY)
}

/// The numbers of a column so far.
struct Numbers {
    width: usize,
    values: Vec<f64>,
    most: u64,
}

impl Numbers {
    /// Takes in the column of a group of rows.
    fn take(&mut self, group: &dyn RowGroupReader, name: &str) -> Result<(), Trouble> {
        let chunks = group.metadata().columns();
        let is_named = |chunk: &ColumnChunkMetaData| {
            chunk.column_path().parts().first().is_some_and(|part| part == name)
        };
        let at = chunks.iter().position(is_named).ok_or(Trouble::NoColumn)?;
        let chunk = chunks.get(at).ok_or(Trouble::NoColumn)?;
        if !matches!(chunk.compression(), Compression::UNCOMPRESSED | Compression::SNAPPY) {
            return Err(Trouble::Compression(chunk.compression().to_string()));
        }
        let stated = u64::try_from(chunk.num_values()).unwrap_or(u64::MAX);
        if stated.saturating_add(self.values.len() as u64) > self.most {
            return Err(Trouble::TooLong);
        }
        let levels = Levels {
            is_optional: chunk.column_descr().max_def_level(),
            is_list: chunk.column_descr().max_rep_level() > 0,
        };
        match group.get_column_reader(at)? {
            ColumnReader::FloatColumnReader(reader) => self.read(reader, &levels, |x| f64::from(*x)),
            ColumnReader::DoubleColumnReader(reader) => self.read(reader, &levels, |x| *x),
            ColumnReader::Int32ColumnReader(reader) => self.read(reader, &levels, |x| f64::from(*x)),
            ColumnReader::Int64ColumnReader(reader) => self.read(reader, &levels, |x| *x as f64),
            ColumnReader::BoolColumnReader(reader) => self.read(reader, &levels, |x| f64::from(u8::from(*x))),
            _ => Err(ParquetError::General(format!("its column {name:?} has no numbers")).into()),
        }
    }

    fn read<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        levels: &Levels,
        number: impl Fn(&T::T) -> f64,
    ) -> Result<(), Trouble> {
        loop {
            let (mut definition, mut repetition, mut values) = (Vec::new(), Vec::new(), Vec::new());
            let (rows, ..) =
                reader.read_records(AT_ONCE, Some(&mut definition), Some(&mut repetition), &mut values)?;
            if rows == 0 {
                return Ok(());
            }
            let mut values = values.iter().map(&number);
            if levels.is_optional == 0 {
                self.values.extend(values);
                continue;
            }
            for (k, level) in definition.iter().enumerate() {
                self.begin(levels, repetition.get(k).copied())?;
                let is_there = *level == levels.is_optional;
                self.values.push(if is_there { values.next().unwrap_or(f64::NAN) } else { f64::NAN });
            }
        }
    }

    /// Refuses a number that begins a row within another one, or continues a row that is complete.
    fn begin(&self, levels: &Levels, repetition: Option<i16>) -> Result<(), Trouble> {
        let begins = !levels.is_list || repetition == Some(0);
        let at_start = self.values.len().is_multiple_of(self.width);
        if begins == at_start || !levels.is_list {
            Ok(())
        } else {
            Err(Trouble::Width(self.values.len() / self.width))
        }
    }
}

/// Levels of a column, which tell missing numbers, and where lists begin.
struct Levels {
    /// Level of a number that is there; 0 if none can be missing.
    is_optional: i16,
    is_list: bool,
}
