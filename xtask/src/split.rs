//! A module in two: what prints call as a rule, and the rest, which is loaded when something in it is first called.

use std::collections::BTreeSet;

use anyhow::{Context, Result, ensure};
use walrus::ir::{MemArg, StoreKind, Value, Visitor, dfs_in_order};
use walrus::{
    ConstExpr, ElementItems, ElementKind, ExportItem, FunctionBuilder, FunctionId, FunctionKind, GlobalId,
    GlobalKind, ImportedFunction, LocalFunction, MemoryId, Module, ModuleConfig, RefType, TableId, passes,
};

/// The function of the module that loads the rest.
const LOAD: &str = "load_rest";

/// What the rest imports from, and the table there of the functions that the rest is called for.
const MAIN: &str = "main";
const TABLE: &str = "rest";

/// Bytes at the far end of the first thread's stack, where marks of as many functions are.
pub const MARKS: usize = 1 << 15;

/// Functions of fewer instructions stay: a call of the rest has as many.
const SMALL: u64 = 8;

/// The module made to mark each function that is called, by a 1 in the byte of memory that has the function's index.
pub fn marking(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut module = parse(bytes)?;
    let memory = module.memories.iter().next().context("a module without memory")?.id();
    for (id, function) in module.funcs.iter_local_mut() {
        ensure!(id.index() < MARKS, "more functions than there is room for their marks");
        let at = MemArg { align: 1, offset: id.index() as u64 };
        let mut body = function.builder_mut().func_body();
        body.const_at(0, Value::I32(0)).const_at(1, Value::I32(1));
        body.store_at(2, memory, StoreKind::I32_8 { atomic: false }, at);
    }
    Ok(module.emit_wasm())
}

/// The module with the functions that are marked, and the rest of it.
pub fn split(bytes: &[u8], marks: &[u8]) -> Result<[Vec<u8>; 2]> {
    let module = parse(bytes)?;
    let load = module.exports.get_func(LOAD)?;
    let stays = |(id, function): &(FunctionId, &LocalFunction)| {
        marks.get(id.index()) == Some(&1) || function.size() < SMALL || *id == load
    };
    let leaving: BTreeSet<FunctionId> =
        module.funcs.iter_local().filter(|function| !stays(function)).map(|(id, _)| id).collect();
    let entries = called_from_main(&module, &leaving).intersection(&leaving).copied().collect();

    // Both parts are parsed from the same bytes: an item has the same index in them.
    let rest = rest(parse(bytes)?, &indices(&leaving), &indices(&entries));
    Ok([main(module, &leaving, &entries)?, rest])
}

fn indices(ids: &BTreeSet<FunctionId>) -> BTreeSet<usize> {
    ids.iter().map(|id| id.index()).collect()
}

/// The functions that calls from elsewhere than the rest lead to.
fn called_from_main(module: &Module, leaving: &BTreeSet<FunctionId>) -> BTreeSet<FunctionId> {
    let staying = module.funcs.iter_local().filter(|(id, _)| !leaving.contains(id));
    let mut called = Uses::of(staying.map(|(_, function)| function)).functions;
    called.extend(module.start);
    for export in module.exports.iter() {
        if let ExportItem::Function(id) = export.item {
            called.insert(id);
        }
    }
    for element in module.elements.iter() {
        match &element.items {
            ElementItems::Functions(ids) => called.extend(ids),
            ElementItems::Expressions(_, items) => {
                called.extend(items.iter().filter_map(|item| match item {
                    ConstExpr::RefFunc(id) => Some(id),
                    _ => None,
                }))
            }
        }
    }
    called
}

/// The module without what leaves: where that is called it calls the rest, which finds what it needs among the exports.
fn main(
    mut module: Module,
    leaving: &BTreeSet<FunctionId>,
    entries: &BTreeSet<FunctionId>,
) -> Result<Vec<u8>> {
    let gone = leaving.iter().map(|&id| module.funcs.get(id).kind.unwrap_local());
    let needed = Uses::of(gone);
    for id in needed.functions.difference(leaving) {
        module.exports.add(&function_name(id.index()), *id);
    }
    for id in needed.globals {
        module.exports.add(&global_name(id.index()), id);
    }
    for id in needed.tables {
        module.exports.add(&table_name(id.index()), id);
    }
    for id in needed.memories {
        module.exports.add(&memory_name(id.index()), id);
    }

    let count = entries.len() as u64;
    let table = module.tables.add_local(false, count, Some(count), RefType::FUNCREF);
    module.exports.add(TABLE, table);
    let load = module.exports.get_func(LOAD)?;
    let mut ready = FunctionBuilder::new(&mut module.types, &[], &[]);
    let mut body = ready.func_body();
    body.i32_const(0).table_get(table).ref_is_null();
    body.if_else(
        None,
        |then| {
            then.call(load);
        },
        |_| {},
    );
    let ready = ready.finish(Vec::new(), &mut module.funcs);
    for (number, &id) in entries.iter().enumerate() {
        let kind = module.funcs.get(id).ty();
        let of_kind = module.types.get(kind);
        let [parameters, results] = [of_kind.params().to_vec(), of_kind.results().to_vec()];
        let arguments: Vec<_> = parameters.iter().map(|&kind| module.locals.add(kind)).collect();
        let mut function = FunctionBuilder::new(&mut module.types, &parameters, &results);
        let mut body = function.func_body();
        body.call(ready);
        for &argument in &arguments {
            body.local_get(argument);
        }
        body.i32_const(number as i32).call_indirect(kind, table);
        module.funcs.get_mut(id).kind = FunctionKind::Local(function.local_func(arguments));
    }
    passes::gc::run(&mut module);
    Ok(module.emit_wasm())
}

/// What leaves, by indices. It puts those that it is called for into the table.
fn rest(mut module: Module, leaving: &BTreeSet<usize>, entries: &BTreeSet<usize>) -> Vec<u8> {
    module.start = None;
    for id in module.exports.iter().map(|export| export.id()).collect::<Vec<_>>() {
        module.exports.delete(id);
    }
    for id in module.elements.iter().map(|element| element.id()).collect::<Vec<_>>() {
        module.elements.delete(id);
    }
    for id in module.data.iter().map(|data| data.id()).collect::<Vec<_>>() {
        module.data.delete(id);
    }
    let imports: Vec<_> = module.imports.iter().map(|import| import.id()).collect();

    let functions: Vec<FunctionId> = module.funcs.iter().map(|function| function.id()).collect();
    for &id in functions.iter().filter(|id| !leaving.contains(&id.index())) {
        let import = module.imports.add(MAIN, &function_name(id.index()), id);
        let function = module.funcs.get_mut(id);
        function.kind = FunctionKind::Import(ImportedFunction { import, ty: function.ty() });
    }
    for id in module.globals.iter().map(|global| global.id()).collect::<Vec<GlobalId>>() {
        let import = module.imports.add(MAIN, &global_name(id.index()), id);
        module.globals.get_mut(id).kind = GlobalKind::Import(import);
    }
    for id in module.tables.iter().map(|table| table.id()).collect::<Vec<TableId>>() {
        let import = module.imports.add(MAIN, &table_name(id.index()), id);
        let table = module.tables.get_mut(id);
        (table.import, table.elem_segments) = (Some(import), Default::default());
    }
    for id in module.memories.iter().map(|memory| memory.id()).collect::<Vec<MemoryId>>() {
        let import = module.imports.add(MAIN, &memory_name(id.index()), id);
        let memory = module.memories.get_mut(id);
        (memory.import, memory.data_segments) = (Some(import), Default::default());
    }
    for id in imports {
        module.imports.delete(id);
    }

    let count = entries.len() as u64;
    let (table, _) = module.add_import_table(MAIN, TABLE, false, count, Some(count), RefType::FUNCREF);
    let kind = ElementKind::Active { table, offset: ConstExpr::Value(Value::I32(0)) };
    let called = functions.into_iter().filter(|id| entries.contains(&id.index())).collect();
    let element = module.elements.add(kind, ElementItems::Functions(called));
    module.tables.get_mut(table).elem_segments.insert(element);
    passes::gc::run(&mut module);
    module.emit_wasm()
}

/// What functions use.
#[derive(Default)]
struct Uses {
    functions: BTreeSet<FunctionId>,
    globals: BTreeSet<GlobalId>,
    tables: BTreeSet<TableId>,
    memories: BTreeSet<MemoryId>,
}

impl Uses {
    fn of<'a>(functions: impl Iterator<Item = &'a LocalFunction>) -> Self {
        let mut uses = Self::default();
        for function in functions {
            dfs_in_order(&mut uses, function, function.entry_block());
        }
        uses
    }
}

impl Visitor<'_> for Uses {
    fn visit_function_id(&mut self, id: &FunctionId) {
        self.functions.insert(*id);
    }

    fn visit_global_id(&mut self, id: &GlobalId) {
        self.globals.insert(*id);
    }

    fn visit_table_id(&mut self, id: &TableId) {
        self.tables.insert(*id);
    }

    fn visit_memory_id(&mut self, id: &MemoryId) {
        self.memories.insert(*id);
    }
}

// What the main part exports an item as, by its index.

fn function_name(index: usize) -> String {
    format!("f{index}")
}

fn global_name(index: usize) -> String {
    format!("g{index}")
}

fn table_name(index: usize) -> String {
    format!("t{index}")
}

fn memory_name(index: usize) -> String {
    format!("m{index}")
}

fn parse(bytes: &[u8]) -> Result<Module> {
    let mut config = ModuleConfig::new();
    config.generate_name_section(false).generate_producers_section(false);
    config.parse(bytes)
}
