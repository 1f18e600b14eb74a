/** Slices models into G-code with a near-optimal order of paths, in Node and in browsers. Lengths are millimetres, times seconds. */

/** Anything that holds bytes; texts are taken as UTF-8. */
export type Bytes = Uint8Array | ArrayBuffer | ArrayBufferView | Blob | string;

/** A model file (STL, 3MF or OBJ), or a project (3MF); with a name, by which messages call it. */
export type ModelFile = Bytes | { name: string; bytes: Bytes };

/** The value of a setting. */
export type Value = string | number | boolean | readonly (string | number | boolean)[];

/** How a model stands on the plate. */
export interface Placement {
  /** Name of the file that it is from. */
  file: string;
  /** The object of the file, counted from 0; without it all of them. */
  object?: number;
  role?: "part" | "support_enforcer" | "support_blocker";
  /** Factors along X, Y and Z. */
  scale?: [number, number, number];
  /** Angles about X, Y and Z, in this order. */
  rotate_deg?: [number, number, number];
  /** Where the middle of its box, seen from above, and its lowest point are; either all models have a position or none. */
  at_mm?: [number, number, number];
  copies?: number;
  /** Settings of its own. */
  settings?: Record<string, Value>;
}

export interface Options {
  /** Built-in profiles by name, the later ones on top. */
  profiles?: string[];
  /** A profile of your own (TOML), on top of those. */
  profile?: string;
  /** Settings by their keys (`"infill.density": "15%"`), on top of all profiles. */
  settings?: Record<string, Value>;
  /** Ends the call, which then throws the signal's reason. */
  signal?: AbortSignal;
  /** Most threads; without it, as many as there are cores, up to 8. A page has more than one if it is cross-origin isolated. */
  threads?: number;
  /** Told of the layers that are done, and of all. */
  onProgress?(done: number, of: number): void;
}

export interface PlateOptions extends Options {
  /** How the models stand; without it, each once and arranged. */
  models?: Placement[];
  /** Layers (`"12"`) or heights (`"12.4mm"`) at which the print stops. */
  pauses?: string[];
  /** The same for filament of another colour. */
  colorChanges?: string[];
  /** Print also what begins in mid-air. */
  allowFloating?: boolean;
  /** Prove how near to the shortest possible the order is. */
  certify?: boolean;
}

export interface SliceOptions extends PlateOptions {
  /** Binary G-code or text; without it, as the settings say. */
  binary?: boolean;
  /** Told of each layer as soon as it is finished, from the bed up. */
  onLayer?(layer: Layer): void;
}

/** A layer as it is printed. */
export interface Layer {
  /** Counted from 0. */
  index: number;
  /** Height of the nozzle over the bed, and of the layer. */
  z: number;
  height: number;
  paths: Path[];
}

/** What is drawn from stop to stop; one number for each vertex, of points three. */
export interface Path {
  /** `External perimeter`, `Internal infill` and so on. */
  role: string;
  points: Float64Array;
  widths: Float64Array;
  /** Speed and duration of the move that ends at the vertex. */
  speeds: Float64Array;
  times: Float64Array;
}

export interface Print {
  /** The file, to the byte that of the program. */
  gcode: Uint8Array;
  /** Size, layers, time, filament, travel: what `pathwright slice --json` prints. */
  summary: Summary;
  /** What is allowed but unwise about the settings. */
  warnings: string[];
}

export interface Summary {
  models: string[];
  size_mm: [number, number, number];
  layer_count: number;
  total_s: number;
  travel_mm: number;
  filament_mm: number;
  filament_g: number;
  layers: Record<string, unknown>[];
  warnings: string[];
  [key: string]: unknown;
}

/** Slices models, together on one plate. */
export function slice(models: ModelFile | ModelFile[], options?: SliceOptions): Promise<Print>;

/** As `slice`, layer by layer as they are finished; gives the print in the end. */
export function layers(
  models: ModelFile | ModelFile[],
  options?: Omit<SliceOptions, "onLayer">,
): AsyncGenerator<Layer, Print, void>;

export interface Row {
  strategy: string;
  link_mm: number;
  bound_mm: number | null;
  gap: number | null;
  travels: number;
  travel_s: number;
  /** Bound of `travel_s`, where times count, and how much more it is, as a share. */
  bound_s: number | null;
  gap_s: number | null;
  layers: Record<string, unknown>[];
  [key: string]: unknown;
}

/** Orders the layers of models by each strategy: a row each. Lengths count, unless `settings` name an `order.cost`. */
export function compare(models: ModelFile | ModelFile[], options?: PlateOptions & { strategies?: string[] }): Promise<Row[]>;

export interface Reordered {
  /** The file; the one that was given where nothing is gained. */
  gcode: Uint8Array;
  /** What was saved: what `pathwright reorder --json` prints. */
  report: { before: { travel_mm: number }; after: { travel_mm: number }; changed: boolean; [key: string]: unknown };
}

/** Shortens the travel in finished G-code of any slicer. Lengths count, unless `settings` name an `order.cost`. */
export function reorder(
  gcode: Bytes,
  options?: Options & { keepDirection?: boolean; moreRetractions?: boolean },
): Promise<Reordered>;

/** Finds the faults of finished G-code; with `against` also beside the models that it should print. */
export function check(
  gcode: Bytes,
  options?: Options & { against?: ModelFile | ModelFile[] },
): Promise<{ errors: number; warnings: number; [key: string]: unknown }>;

/** How long finished G-code takes. */
export function time(gcode: Bytes, options?: Options): Promise<{ total_s: number; [key: string]: unknown }>;

export type Polyline = readonly (readonly [number, number])[];

export interface Order {
  /** Which polyline is next. */
  order: number[];
  /** How it is drawn: an open one forwards (0) or backwards (1), a closed one from this vertex. */
  entries: number[];
  length_mm: number;
  /** No order has less between lines; with `certify`. */
  bound_mm: number | null;
}

/** Finds the order of polylines in which little is travelled between them. */
export function order(
  polylines: readonly Polyline[],
  options?: {
    /** Which are loops, begun at any vertex; one for all, or one each. */
    closed?: boolean | boolean[];
    /** Those of a smaller number come first. */
    groups?: number[];
    start?: [number, number];
    strategy?: string;
    effort?: "fast" | "normal" | "high";
    certify?: boolean;
    signal?: AbortSignal;
    threads?: number;
  },
): Promise<Order>;

/** Every setting with meaning, range, unit and default. */
export function schema(): Promise<{ groups: { name: string; title: string; help: string; settings: Record<string, unknown>[] }[] }>;

/** The built-in profiles. */
export function profiles(): Promise<{ name: string; kind: "printer" | "material" | "quality" | "job"; help: string }[]>;

/** Another slicer's configuration (`.ini`) as a profile (TOML), for `profile`. */
export function convert(name: string, text: string): Promise<string>;

/** Version of the slicer. */
export function version(): Promise<string>;

/** Why something was not done. */
export class PathwrightError extends Error {
  /** `limit`: it takes more memory than there is. */
  kind: "usage" | "input" | "settings" | "does_not_fit" | "check" | "limit" | "internal";
  /** The file, place in it, object and setting that are at fault, where they are known. */
  file?: string | null;
  place?: string | null;
  object?: string | null;
  key?: string | null;
}
