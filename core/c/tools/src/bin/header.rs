//! Writes the header of the library to standard output, for the family, sizes and prefix of names that this program is built for.

#[path = "../../../src/config.rs"]
mod config;

use cbindgen::{
    Braces, Builder, Config, DocumentationStyle, EnumConfig, ItemType, Language, RenameRule, SortKey, Style,
};
use std::error::Error;
use std::path::{Path, PathBuf};

/// Introduction of the header.
const INTRODUCTION: &str = include_str!("../introduction.h");

/// C names of the types.
const NAMES: [(&str, &str); 12] = [
    ("Model", "leastaction_model"),
    ("State", "leastaction_state"),
    ("Status", "leastaction_status"),
    ("Error", "leastaction_error"),
    ("Newton", "leastaction_newton"),
    ("Report", "leastaction_report"),
    ("Outside", "leastaction_outside"),
    ("Plan", "leastaction_plan"),
    ("PlanDescription", "leastaction_plan_description"),
    ("Adapter", "leastaction_adapter"),
    ("Found", "leastaction_found"),
    ("Number", "leastaction_number"),
];

/// Sizes that this program was built for.
fn sizes() -> Vec<(&'static str, usize)> {
    let mut sizes = vec![
        ("LEASTACTION_ABI", config::LEASTACTION_ABI as usize),
        ("LEASTACTION_COORDINATES", config::LEASTACTION_COORDINATES),
    ];
    #[cfg(not(any(feature = "bodies", feature = "arm")))]
    sizes.extend([
        ("LEASTACTION_HIDDEN", config::LEASTACTION_HIDDEN),
        ("LEASTACTION_LAYERS", config::LEASTACTION_LAYERS),
    ]);
    #[cfg(feature = "networks")]
    sizes.extend([
        ("LEASTACTION_LAW_HIDDEN", config::LEASTACTION_LAW_HIDDEN),
        ("LEASTACTION_LAW_LAYERS", config::LEASTACTION_LAW_LAYERS),
    ]);
    #[cfg(feature = "modular")]
    sizes.push(("LEASTACTION_TYPES", config::LEASTACTION_TYPES));
    #[cfg(feature = "graph")]
    sizes.extend([
        ("LEASTACTION_DIMENSIONS", config::LEASTACTION_DIMENSIONS),
        ("LEASTACTION_NETWORKS", config::LEASTACTION_NETWORKS),
        ("LEASTACTION_EDGES", config::LEASTACTION_EDGES),
    ]);
    #[cfg(feature = "rods")]
    sizes.push(("LEASTACTION_RODS", config::LEASTACTION_RODS));
    #[cfg(feature = "adapt")]
    sizes.extend([
        ("LEASTACTION_NUMBERS", config::LEASTACTION_NUMBERS),
        ("LEASTACTION_ADAPTER_WORDS", config::LEASTACTION_ADAPTER_WORDS),
        ("LEASTACTION_PATCH_BYTES", config::LEASTACTION_PATCH_BYTES),
    ]);
    sizes.push(("LEASTACTION_MODEL_WORDS", config::LEASTACTION_MODEL_WORDS));
    sizes.push(("LEASTACTION_STATE_WORDS", config::LEASTACTION_STATE_WORDS));
    sizes.push(("LEASTACTION_PLAN_WORDS", config::LEASTACTION_PLAN_WORDS));
    sizes
}

fn family() -> &'static str {
    if cfg!(feature = "modular") {
        "MODULAR"
    } else if cfg!(feature = "graph") {
        "GRAPH"
    } else if cfg!(feature = "bodies") {
        "BODIES"
    } else if cfg!(feature = "arm") {
        "ARM"
    } else {
        "INERTIA_NETWORK"
    }
}

fn defines() -> String {
    let sizes = sizes().into_iter().map(|(name, size)| format!("#define {name} {size}\n"));
    format!("\n/* Family and sizes that the library was built for. */\n#define LEASTACTION_{} 1\n", family())
        + &sizes.collect::<String>()
}

fn settings() -> Config {
    let mut settings = Config {
        language: Language::C,
        header: Some(INTRODUCTION.trim_end().into()),
        include_guard: Some("LEASTACTION_H".into()),
        no_includes: true,
        sys_includes: ["stddef.h", "stdint.h"].map(String::from).into(),
        after_includes: Some(defines()),
        cpp_compat: true,
        style: Style::Type,
        braces: Braces::SameLine,
        line_length: 110,
        tab_width: 4,
        usize_is_size_t: true,
        documentation_style: DocumentationStyle::Doxy,
        sort_by: SortKey::None,
        enumeration: EnumConfig {
            rename_variants: RenameRule::QualifiedScreamingSnakeCase,
            ..EnumConfig::default()
        },
        ..Config::default()
    };
    settings.export.item_types =
        vec![ItemType::Enums, ItemType::Structs, ItemType::Typedefs, ItemType::Functions];
    settings.export.rename = NAMES.map(|(from, to)| (from.into(), to.into())).into();
    settings
}

/// Copies a source file in which the functions have the names by which they are called, without a prefix, because a
/// header generator knows only names that are written out.
fn written_out(file: &Path) -> Result<String, Box<dyn Error>> {
    let source = std::fs::read_to_string(file)?;
    let line = |line: &str| match line.contains("export_name") {
        true => "#[unsafe(no_mangle)]\n".into(),
        false => format!("{line}\n"),
    };
    Ok(source.lines().map(line).collect())
}

/// Replaces the prefix of all names, also in capitals.
fn renamed(header: &str, prefix: &str) -> String {
    let guard = format!("{}H", prefix.to_uppercase());
    let header = header.replace("leastaction_", prefix).replace("LEASTACTION_H", &guard);
    header.replace("LEASTACTION_", &prefix.to_uppercase())
}

fn main() -> Result<(), Box<dyn Error>> {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src");
    let copies: PathBuf = std::env::temp_dir().join(format!("leastaction-header-{}", std::process::id()));
    std::fs::create_dir_all(&copies)?;
    let mut builder = Builder::new().with_config(settings());
    let files = [
        "status", "error", "storage", "messages", "load", "said", "evaluate", "start", "step", "plan",
        "follow",
    ];
    let beside = if cfg!(feature = "rods") { "rods" } else { "terms" };
    let adapts: &[_] = if cfg!(feature = "adapt") { &["adapter", "found", "patch"] } else { &[] };
    for file in files.into_iter().chain([beside]).chain(adapts.iter().copied()) {
        let copy = copies.join(file).with_extension("rs");
        std::fs::write(&copy, written_out(&sources.join(file).with_extension("rs"))?)?;
        builder = builder.with_src(copy);
    }
    let mut header = Vec::new();
    builder.generate()?.write(&mut header);
    std::fs::remove_dir_all(copies)?;
    let prefix = std::env::var("LEASTACTION_PREFIX").unwrap_or_else(|_| "leastaction_".into());
    print!("{}", renamed(&String::from_utf8(header)?, &prefix));
    Ok(())
}
