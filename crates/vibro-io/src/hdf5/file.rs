//! Reads the groups, datasets and attributes of a file.
//!
//! The crate hdf5-reader returns only the size of integers and floats. Numbers of another bit layout, as
//! stated in their datatype message, are not read.

use super::lzf;
use crate::assemble::fewer;
use crate::binary::NumberType;
use crate::held::{Held, rises};
use crate::options::Options;
use crate::source::Source;
use crate::variables::EXPORT;
use hdf5_reader::attribute_api::Attribute;
use hdf5_reader::dataset::{Dataset, SliceInfo, SliceInfoElem};
use hdf5_reader::error::Error as Fault;
use hdf5_reader::group::Group;
use hdf5_reader::messages::HdfMessage;
use hdf5_reader::messages::datatype::{ReferenceType, VarLenKind};
use hdf5_reader::storage::FileStorage;
use hdf5_reader::{
    ByteOrder, CompoundField, Datatype, ExternalLinkResolver, FilterRegistry, H5Type, Hdf5File, OpenOptions,
};
use num_complex::Complex64;
use rayon::prelude::*;
use std::cell::{Cell, OnceCell};
use std::collections::{BTreeSet, HashSet};
use std::sync::{Arc, Mutex};
use vibro_record::lanes::Extremes;
use vibro_record::{Error, Finding, Result, Values};

/// Most bytes that a filter unpacks from one byte: deflate needs at least two bits for 258 bytes.
const MOST_UNPACKED: u64 = 1032;
/// Ratio of declared to file bytes above which only the written part of a dataset is read, since the rest
/// may never have been written. A smaller ratio may result from compression.
const MANY: u64 = 16;
/// Deepest nesting of groups, and longest path in bytes, that are read.
const MOST_DEPTH: usize = 32;
pub const MOST_PATH: usize = 512;
/// Values read at a time; few in tests, so that small fixtures have several blocks.
const BLOCK: usize = if cfg!(test) { 8 } else { 1 << 15 };

/// Names of the real and the imaginary field of complex numbers.
const COMPLEX: &[(&str, &str)] = &[("r", "i"), ("real", "imag"), ("re", "im")];

/// Content of a dataset or an attribute.
#[derive(Debug)]
pub enum Data {
    Numbers(Held),
    /// Columns by the name of their field; `None` for a field that is not a number.
    Table(Vec<(String, Option<Vec<f64>>)>),
    Texts(Vec<String>),
    /// Addresses of other objects.
    References(Vec<u64>),
    /// A class that is skipped, by its name.
    Other(&'static str),
}

/// A member of a group.
pub enum Member {
    Group(Group),
    Dataset(Box<Dataset>),
}

impl Member {
    pub fn address(&self) -> u64 {
        match self {
            Member::Group(group) => group.address(),
            Member::Dataset(dataset) => dataset.address(),
        }
    }

    pub fn attributes(&self) -> Vec<Attribute> {
        match self {
            Member::Group(group) => group.attributes().unwrap_or_default(),
            Member::Dataset(dataset) => dataset.attributes(),
        }
    }
}

/// An open file, with findings on what was skipped in it.
pub struct File {
    open: Hdf5File,
    len: u64,
    outside: Arc<Outside>,
    /// Addresses of groups and datasets already returned: a second link to one is skipped.
    seen: HashSet<u64>,
    options: Options,
    /// Number of values in memory so far.
    held: Cell<f64>,
    /// The error, if more values are needed than the memory limit allows.
    pub refused: OnceCell<Error>,
    pub findings: Vec<Finding>,
}

/// Names of other files that links lead to. None of these files is opened.
#[derive(Default)]
struct Outside(Mutex<BTreeSet<String>>);

impl ExternalLinkResolver for Outside {
    fn resolve_external_link(&self, file: &str) -> std::result::Result<Option<Hdf5File>, Fault> {
        self.0.lock().map(|mut files| files.insert(file.to_owned())).ok();
        Ok(None)
    }
}

impl File {
    pub fn open(source: &Source, options: &Options) -> Result<File> {
        let limit = options.clone();
        let most = usize::try_from(source.len().saturating_mul(MOST_UNPACKED)).unwrap_or(usize::MAX);
        let outside = Arc::new(Outside::default());
        let mut filters = FilterRegistry::new();
        filters.register(lzf::ID, Box::new(|filter, packed, _| lzf::unpack(filter, packed)));
        let options = OpenOptions::default()
            .with_filter_registry(filters)
            .with_external_link_resolver(outside.clone())
            .with_chunk_cache_bytes(0)
            .with_max_chunk_bytes(most);
        let open = match source.in_memory() {
            Some(bytes) => Hdf5File::from_bytes_with_options(bytes, options),
            None => FileStorage::open(source.path())
                .and_then(|file| Hdf5File::from_storage_with_options(Arc::new(file), options)),
        };
        let open = open.map_err(|fault| damaged(&fault))?;
        let (held, refused) = (Cell::new(0.0), OnceCell::new());
        let (seen, findings) = (HashSet::new(), Vec::new());
        Ok(File { open, len: source.len(), outside, seen, options: limit, held, refused, findings })
    }

    /// Reserves memory for this many more values; fails beyond the limit.
    fn hold(&self, values: f64) -> std::result::Result<(), Fault> {
        self.held.set(self.held.get() + values);
        self.options.hold(self.held.get()).map_err(|error| {
            let fault = Fault::InvalidData(error.to_string());
            let _ = self.refused.set(error);
            fault
        })
    }

    pub fn root(&mut self) -> Result<Group> {
        let root = self.open.root_group().map_err(|fault| damaged(&fault))?;
        self.seen.insert(root.address());
        Ok(root)
    }

    /// Members of a group by name, without those already reached under another name.
    pub fn members(&mut self, group: &Group, path: &str) -> Result<Vec<(String, Member)>> {
        if path.len() > MOST_PATH || path.split(['/', '.']).count() > MOST_DEPTH {
            self.pass(path, "group too deep in others");
            return Ok(Vec::new());
        }
        let (groups, datasets) = group.member_names().map_err(|fault| damaged(&fault))?;
        let groups = groups.into_iter().map(|name| (group.group(&name).map(Member::Group), name));
        let dataset = |name: &str| group.dataset(name).map(|inner| Member::Dataset(Box::new(inner)));
        let mut found: Vec<_> =
            groups.chain(datasets.into_iter().map(|name| (dataset(&name), name))).collect();
        found.sort_by(|a, b| a.1.cmp(&b.1));
        let mut members = Vec::new();
        for (member, name) in found {
            match member {
                Ok(member) if self.seen.insert(member.address()) => members.push((name, member)),
                Ok(_) => self.pass(&name, "second link"),
                Err(fault) => self.unreadable(&name, &fault),
            }
        }
        Ok(members)
    }

    pub fn pass(&mut self, name: &str, class: &str) {
        self.findings.push(Finding::note("variable-passed-over").name("variable", name).name("class", class));
    }

    fn unreadable(&mut self, name: &str, fault: &Fault) {
        let found = Finding::caution("dataset-unreadable").name("variable", name);
        self.findings.push(found.name("reason", fault.to_string()));
    }

    /// Findings of the file as a whole.
    pub fn close(mut self) -> Vec<Finding> {
        let outside = self.outside.0.lock().map(|files| files.clone()).unwrap_or_default();
        let left = outside.into_iter().map(|file| Finding::caution("link-not-followed").name("file", file));
        self.findings.extend(left);
        self.findings
    }

    /// Content of a dataset. With `summary`, numbers that do not rise are only summarised. A dataset that
    /// cannot be read gives a finding.
    pub fn data(&mut self, name: &str, dataset: &Dataset, summary: bool) -> Option<Data> {
        match self.content(dataset, summary) {
            Ok(Data::Other(class)) => self.pass(name, class),
            Ok(data) => {
                let declared = dataset.num_elements().unwrap_or_default() as usize;
                if let Data::Numbers(values) = &data
                    && values.len() < declared
                {
                    self.findings.push(fewer(declared, values.len()).about(name));
                }
                return Some(data);
            }
            Err(fault) => self.unreadable(name, &fault),
        }
        None
    }

    fn content(&self, dataset: &Dataset, summary: bool) -> std::result::Result<Data, Fault> {
        let header = self.open.get_or_parse_header(dataset.address())?;
        let packed = header.messages.iter().any(|message| matches!(message, HdfMessage::FilterPipeline(_)));
        let (declared, most) = (dataset.raw_byte_len()? as u64, if packed { MOST_UNPACKED } else { 1 });
        let layout = dataset.raw_datatype()?;
        if declared > self.len.saturating_mul(most.min(MANY)) && dataset.ndim() == 1 {
            // Counted in values of 8 bytes: the bytes read, and the numbers decoded from them.
            let values = |bytes: usize| self.held.get() + bytes as f64 / 4.0;
            let room = |bytes: usize| {
                // Beyond the limit, the error states the memory that the declared size needs.
                self.options.hold(values(bytes)).or_else(|_| self.hold(declared as f64 / 4.0))
            };
            let there = match written(dataset, room) {
                Err(fault) if self.refused.get().is_some() => return Err(fault),
                there => there.unwrap_or_default(),
            };
            if !there.is_empty() {
                self.held.set(values(there.len()));
                return decoded(dataset.dtype(), &layout, dataset.raw_element_size()?, || Ok(there));
            }
        }
        if declared > self.len.saturating_mul(most) {
            let found = format!("{declared} bytes are declared, the file has {}", self.len);
            return Err(Fault::InvalidData(found));
        }
        match dataset.dtype() {
            _ if dataset.num_elements()? == 0 => Ok(Data::Numbers(Values::Real(Vec::new()).into())),
            Datatype::String { .. } | Datatype::VarLen { kind: VarLenKind::String, .. } => {
                Ok(Data::Texts(dataset.read_strings()?))
            }
            kind if number(kind).is_some() && described(&layout, &[kind])[0] && dataset.ndim() > 0 => {
                Ok(Data::Numbers(by_rows(dataset, summary, |values| self.hold(values))?))
            }
            kind => {
                self.hold(declared as f64 / 4.0)?;
                decoded(kind, &layout, dataset.raw_element_size()?, || dataset.read_raw_bytes())
            }
        }
    }
}

/// Refuses a file that the crate cannot open.
fn damaged(fault: &Fault) -> Error {
    Error::usage(fault.to_string(), "HDF5 that can be read").hint(EXPORT)
}

/// The bytes of a dataset of one dimension up to the first chunk that was not written.
fn written(
    dataset: &Dataset,
    room: impl Fn(usize) -> std::result::Result<(), Fault>,
) -> std::result::Result<Vec<u8>, Fault> {
    let (size, mut bytes) = (dataset.raw_element_size()?, Vec::new());
    let (mut chunks, mut held) = (Vec::new(), 0);
    for chunk in dataset.iter_chunks()? {
        let chunk = chunk?;
        held += chunk.bytes().len();
        room(held)?;
        chunks.push(chunk);
    }
    chunks.sort_by_key(|chunk| chunk.offsets()[0]);
    for chunk in chunks {
        if chunk.offsets()[0] as usize * size == bytes.len() {
            bytes.extend_from_slice(chunk.bytes());
        }
    }
    bytes.truncate(dataset.raw_byte_len()?);
    Ok(bytes)
}

/// A number of any integer or float type, as a double.
#[derive(Clone)]
struct Number(f64);

impl H5Type for Number {
    fn hdf5_type() -> Datatype {
        f64::hdf5_type()
    }

    fn from_bytes(bytes: &[u8], kind: &Datatype) -> std::result::Result<Number, Fault> {
        let number = column(bytes, 0, bytes.len(), kind).and_then(|values| values.first().copied());
        number.map(Number).ok_or_else(|| Fault::InvalidData(format!("{kind:?} in place of a number")))
    }

    fn element_size(kind: &Datatype) -> usize {
        number(kind).map_or(0, |(kind, _)| kind.size() as usize)
    }

    fn decode_vec(
        bytes: &[u8],
        kind: &Datatype,
        n: usize,
    ) -> Option<std::result::Result<Vec<Number>, Fault>> {
        let size = Number::element_size(kind);
        let values = column(bytes.get(..n.checked_mul(size)?)?, 0, size, kind)?;
        Some(Ok(values.into_iter().map(Number).collect()))
    }
}

/// Reads the numbers of a dataset in blocks of rows, which needs little memory besides the values. With
/// `summary`, only extremes and first values are kept, if the first block does not rise and no value is
/// missing.
fn by_rows(
    dataset: &Dataset,
    summary: bool,
    hold: impl Fn(f64) -> std::result::Result<(), Fault>,
) -> std::result::Result<Held, Fault> {
    let (n, all) = (dataset.num_elements()? as usize, dataset.shape()[0]);
    let row = n / all as usize;
    let chunk = dataset.chunks().and_then(|chunk| chunk.first().copied()).unwrap_or(1).max(1) as usize;
    let rows = (BLOCK / row).max(1).next_multiple_of(chunk);
    let block = |k: usize| {
        let (start, mut slice) = ((k * rows) as u64, SliceInfo::all(dataset.ndim()));
        let end = all.min(start + rows as u64);
        slice.selections[0] = SliceInfoElem::Slice { start, end, step: 1 };
        let numbers = dataset.read_slice::<Number>(&slice)?.into_raw_vec_and_offset().0;
        Ok(numbers.into_iter().map(|Number(value)| value).collect::<Vec<f64>>())
    };
    let blocks = n.div_ceil(rows * row);
    // Room for one block in each thread.
    let threads = rayon::current_num_threads().clamp(1, blocks);
    hold((threads * rows * row) as f64)?;
    // Columns of a matrix are copied later: twice the room.
    let room = if row > 1 { 2 * n } else { n } as f64;
    if summary && blocks > 1 && !rises(&block(0)?) {
        let parts = (0..blocks).into_par_iter().map(|k| block(k).map(|values| Extremes::of(&values)));
        let mut whole = Extremes::NONE;
        parts.collect::<std::result::Result<Vec<_>, Fault>>()?.into_iter().for_each(|part| whole.join(&part));
        if whole.finite() {
            return Ok(Held::Summary(whole));
        }
    }
    hold(room)?;
    let mut values = vec![0.0; n];
    values.par_chunks_mut(rows * row).enumerate().try_for_each(|(k, part)| {
        part.copy_from_slice(&block(k)?);
        Ok::<(), Fault>(())
    })?;
    Ok(Values::Real(values).into())
}

/// Content of an attribute.
pub fn attribute(attribute: &Attribute) -> Option<Data> {
    if let Ok(texts) = attribute.read_strings() {
        return Some(Data::Texts(texts));
    }
    let kind = &attribute.datatype;
    let layout = description(kind).unwrap_or_default();
    let size = hdf5_reader::dtype_element_size(kind).ok()?;
    decoded(kind, &layout, size, || Ok(attribute.raw_data.clone())).ok()
}

/// Decodes the bytes that `read` returns: elements of `size` bytes, whose datatype message is `layout`.
fn decoded(
    kind: &Datatype,
    layout: &[u8],
    size: usize,
    read: impl FnOnce() -> std::result::Result<Vec<u8>, Fault>,
) -> std::result::Result<Data, Fault> {
    Ok(match kind {
        Datatype::FixedPoint { .. } | Datatype::FloatingPoint { .. } if described(layout, &[kind])[0] => {
            Data::Numbers(Values::Real(column(&read()?, 0, size, kind).unwrap_or_default()).into())
        }
        Datatype::FixedPoint { .. } | Datatype::FloatingPoint { .. } => {
            Data::Other("number of an unusual layout")
        }
        Datatype::Compound { fields, .. } => {
            let exact = described(layout, &fields.iter().map(|field| &field.datatype).collect::<Vec<_>>());
            let bytes = read()?;
            let column = |(field, exact): (&CompoundField, bool)| {
                let column = || column(&bytes, field.byte_offset as usize, size, &field.datatype);
                (field.name.clone(), exact.then(column).flatten())
            };
            let columns: Vec<_> = fields.iter().zip(exact).map(column).collect();
            match &columns[..] {
                [(r, Some(re)), (i, Some(im))] if COMPLEX.contains(&(r.as_str(), i.as_str())) => {
                    let pairs = re.iter().zip(im).map(|(re, im)| Complex64::new(*re, *im));
                    Data::Numbers(Values::Complex(pairs.collect()).into())
                }
                _ => Data::Table(columns),
            }
        }
        Datatype::Reference { ref_type: ReferenceType::Object, .. } => {
            let addresses = read()?.as_chunks().0.iter().map(|bytes| u64::from_le_bytes(*bytes)).collect();
            Data::References(addresses)
        }
        Datatype::Enum { .. } => Data::Other("enumeration"),
        Datatype::VarLen { .. } => Data::Other("dataset of rows of different lengths"),
        _ => Data::Other("dataset of neither numbers nor text"),
    })
}

/// Number type of a datatype, and whether it is big-endian; `None` if it is not a number.
fn number(kind: &Datatype) -> Option<(NumberType, bool)> {
    /// Added to the size in bytes: an unsigned integer, a float.
    const UNSIGNED: u32 = 0x100;
    const FLOAT: u32 = 0x200;
    let (code, order) = match kind {
        Datatype::FixedPoint { size, signed, byte_order } => {
            (u32::from(*size) | if *signed { 0 } else { UNSIGNED }, byte_order)
        }
        Datatype::FloatingPoint { size, byte_order } => (u32::from(*size) | FLOAT, byte_order),
        _ => return None,
    };
    let kind = NumberType::coded(code, [1, 2, 4, 8, 0x101, 0x102, 0x104, 0x108, 0x204, 0x208])?;
    Some((kind, *order == ByteOrder::BigEndian))
}

/// The numbers at byte `offset` of each row of `width` bytes; `None` if they are not numbers or do not fit.
fn column(bytes: &[u8], offset: usize, width: usize, of: &Datatype) -> Option<Vec<f64>> {
    let ((kind, big_endian), mut column) = (number(of)?, Vec::new());
    (offset as u64 + kind.size() <= width as u64).then_some(())?;
    kind.take(bytes, offset, width, big_endian, &mut column);
    Some(column)
}

/// The datatype message, without its class byte, of an integer that fills its bytes or of an IEEE 754 float.
fn description(kind: &Datatype) -> Option<Vec<u8>> {
    let (number, big_endian) = number(kind)?;
    let (flags, sign, properties): (u8, u8, &[u8]) = match (number, kind) {
        (NumberType::F32, _) => (0x20, 31, &[23, 8, 0, 23, 127, 0, 0, 0]),
        (NumberType::F64, _) => (0x20, 63, &[52, 11, 0, 52, 0xff, 3, 0, 0]),
        (_, Datatype::FixedPoint { signed: true, .. }) => (8, 0, &[]),
        _ => (0, 0, &[]),
    };
    let size = number.size() as u8;
    let flags = flags | u8::from(big_endian);
    Some([&[flags, sign, 0, size, 0, 0, 0, 0, 0, size * 8, 0], properties].concat())
}

/// Whether the message `layout` contains the description above of each datatype, in this order.
fn described(layout: &[u8], kinds: &[&Datatype]) -> Vec<bool> {
    let mut rest = layout;
    let mut next = |kind: &&Datatype| {
        let bytes = description(kind)?;
        let at = rest.windows(bytes.len()).position(|window| window == bytes)?;
        rest = &rest[at + bytes.len()..];
        Some(())
    };
    kinds.iter().map(|kind| next(kind).is_some()).collect()
}
