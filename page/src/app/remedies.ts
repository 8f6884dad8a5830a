// Gives each fact of the engine whose remedy names a control a button that does it or leads there.
import type { FactFields, FactId } from "../facts";
import type { PageRequest } from "../protocol";
import type { Editor } from "./editor";
import { graftRemedy } from "./graft/graft_remedies";
import type { GraftFields } from "./graft/graft_step";
import { mirrorTolerance, asPercent } from "./symmetry";
import { reveal, type Place } from "./reveal";
import type { ToolName } from "./tool_settings";
import { formatNumber } from "./units";

/** Something that the page can do about a fact, or a place that it can show, with the label of its button. */
export interface Remedy {
  readonly label: string;
  /** The place that the button leads to, if it leads to one. */
  readonly place?: Place;
  run(editor: Editor): unknown;
}

type Refused = PageRequest | undefined;
type RemedyTable = { readonly [Id in FactId]?: (fields: FactFields[Id], refused: Refused) => Remedy | undefined };

const show = (label: string, place: Place): Remedy => ({ label, place, run: (editor) => reveal(editor, place) });

const moreSettings = (control: string) =>
  show(`Show ${control}`, { mode: "deform", section: "Method", more: "More settings", control });
const inGraft = (control: string) => show(`Show ${control}`, { mode: "graft", section: "Graft", control });
const inSymmetry = (control: string) => show(`Show ${control}`, { mode: "deform", section: "Symmetry", control });

const showReach = () => show("Show Reach", { mode: "deform", section: "Handles", control: "Reach" });
const showProxy = () => moreSettings("Proxy vertices");
const showGraft = () => show("Show the graft", { mode: "graft", section: "Graft", control: "Accept" });
const showParts = () => show("Show the parts", { mode: "graft", section: "Parts" });
const showLibrary = () => show("Show the part library", { mode: "graft", section: "Part library" });
const showSteps = () => show("Show the steps", { section: "Steps" });
const showDefects = () => show("Show the defects", { section: "Defects" });
const addFolder = () => show("Add a folder…", { dialog: "open", control: "Add a folder…" });
const saveAs = (): Remedy => ({ label: "Save as…", run: ({ dialog }) => (dialog.value = "save") });
const undo = (label = "Undo"): Remedy => ({ label, run: (editor) => editor.undoOrRedo("undo") });
const symmetryOff = (): Remedy => ({ label: "Switch symmetry off", run: (editor) => editor.setSymmetry(false) });
const changeSettings = (label: string, settings: Record<string, string | boolean>): Remedy => ({
  label,
  run: (editor) => editor.ask({ do: "settings", settings }),
});
const removeHandle = (name: string): Remedy => ({
  label: `Remove “${name}”`,
  run: (editor) => editor.ask({ do: "handle", what: "remove", name }),
});
const tolerate = (tolerance_rel: number): Remedy => ({
  label: `Use ${formatNumber(asPercent(tolerance_rel))} %`,
  run: (editor) => {
    mirrorTolerance.value = tolerance_rel;
    const plane = editor.state.value?.symmetry?.plane;
    return editor.ask({ do: "symmetry", ...(plane === undefined ? {} : { plane }), tolerance_rel });
  },
});

const take = (tool: ToolName, label: string): Remedy => ({
  label,
  run: ({ tools, graft }) => {
    graft.mode.value = "deform";
    tools.tool.value = tool;
  },
});
const paintHandle = () => take("handle", "Paint a handle");
const selectMore = () => take("brush", "Select with the brush");

/** Shows model and part apart, where their loops can be clicked. */
const showLoops = (): Remedy => ({
  label: "Show the loops",
  run: ({ graft }) => {
    graft.mode.value = "graft";
    graft.tool.value = "loops";
    graft.arrangement.value = "apart";
  },
});

/** Takes back the graft that is edited, since nothing else can be changed meanwhile. */
async function leaveGraft({ graft }: Editor): Promise<void> {
  if (graft.isEdited.value) await graft.cancel();
}

type Side = "source" | "target";
const nameOf = ({ graft }: Editor, side: Side) => (side === "source" ? graft.source : graft.model).value?.name;

/** Cancels the graft, and begins to cut the part or the model by a plane. */
const cutOpen = (side: Side): Remedy => ({
  label: side === "source" ? "Cut the part open" : "Cut the model open",
  run: async (editor) => {
    const name = nameOf(editor, side);
    await leaveGraft(editor);
    const { graft } = editor;
    graft.mode.value = "graft";
    graft.arrangement.value = "apart";
    graft.tool.value = "plane";
    if (side === "source" && name !== undefined) await reveal(editor, { control: "Cut" });
  },
});

/** Cancels the graft, and mends the part or the model. */
const mend = (side: Side): Remedy => ({
  label: side === "source" ? "Mend the part" : "Mend the model",
  run: async (editor) => {
    const name = nameOf(editor, side);
    await leaveGraft(editor);
    if (name !== undefined && editor.graft.byName(name) !== undefined) await editor.mending.mend(name);
  },
});

/** Mends the object that a refused request is about. */
const mendObject = (refused: Refused, change: "mend" | "closeHoles" = "mend"): Remedy => ({
  label: change === "mend" ? "Mend it" : "Close the holes",
  run: async (editor) => {
    const name = (refused?.do === "cut" ? refused.mesh : undefined) ?? nameOf(editor, "target");
    if (name !== undefined) await editor.mending[change](name);
  },
});

/** Changes how the cut that was refused is closed, and shows where it is chosen. A cut of an earlier step is shown. */
const closeCut = (refused: Refused, label: string, cap: "open" | "flat" | "pins"): Remedy =>
  refused?.do === "step"
    ? showSteps()
    : {
        label,
        run: async (editor) => {
          const { side, count } = editor.graft.cutClosing.value.pins ?? {};
          editor.graft.cutClosing.value = cap === "pins" ? { cap, pins: { ...(side && { side }), ...(count && { count }) } } : { cap };
          await reveal(editor, { mode: "graft", control: "Close" });
        },
      };
const drawAgain = (): Remedy => ({
  label: "Draw again",
  run: ({ graft }) => {
    graft.mode.value = "graft";
    graft.tool.value = "stroke";
    graft.cutCurve.value = null;
  },
});

const remedies: RemedyTable = {
  "deform.axis_without_length": () => show("Show Rotation axis", { mode: "deform", section: "Handles", control: "Rotation axis" }),
  "deform.component_held_by_positions": paintHandle,
  "deform.component_not_held": paintHandle,
  "deform.frames_not_linear": () => changeSettings("Use Linear", { method: "ft05" }),
  "deform.no_proxy": showProxy,
  "deform.nothing_free": showReach,
  "deform.proxy_solution_not_finite": () => undo(),
  "deform.smoothed_away": () => show("Show Strength", { mode: "deform", control: "Strength" }),
  "deform.solution_not_finite": () => undo(),
  "deform.solve_exceeds_memory": showProxy,
  "deform.vertex_not_finite": (_, refused) => mendObject(refused),

  "editor.defects": showDefects,
  "editor.edit_without_file": saveAs,
  "editor.ended_in_step": () => undo("Undo once"),
  "editor.faces_change": () => show("Show the switch", { dialog: "export", control: "As a morph target" }),
  "editor.file_changed": saveAs,
  "editor.graft_in_work": showGraft,
  "editor.graft_side_missing": showLoops,
  "editor.grafted_onto_itself": showLibrary,
  "editor.handle_follows": symmetryOff,
  "editor.handle_without_reach": selectMore,
  "editor.held_already": paintHandle,
  "editor.is_model": showParts,
  "editor.journal_not_written": saveAs,
  "editor.no_folder": addFolder,
  "editor.no_graft_to_resume": showSteps,
  "editor.no_part": showLibrary,
  "editor.nothing_open": () => ({ label: "Open…", run: ({ dialog }) => (dialog.value = "open") }),
  "editor.only_step": () => undo(),
  "editor.outside_folders": addFolder,
  "editor.part_in_use": showSteps,
  "editor.part_unclear": showParts,
  "editor.start_off_loops": showLoops,
  "editor.step_beside_graft": showGraft,
  "editor.step_does_nothing": paintHandle,
  "editor.steps_set_aside": showGraft,

  "io.no_morph_targets": () => show("Show Format", { dialog: "export", control: "Format" }),

  "linalg.matrix_too_large": showProxy,
  "linalg.no_multifrontal_solver": () => changeSettings("Use the automatic solver", { backend: "auto" }),
  "linalg.no_room_for_buffers": showReach,
  "linalg.not_converged": () => moreSettings("Solver"),
  "linalg.not_positive_definite": () => moreSettings("Flat areas"),
  "linalg.operator_too_large": showProxy,

  "merge.base_cuts_open_chain": () => inGraft("Base"),
  "merge.base_divides_source": () => inGraft("Base"),
  "merge.base_has_too_many_loops": () => inGraft("Base"),
  "merge.base_height_outside": () => inGraft("Base"),
  "merge.base_is_hollow": () => cutOpen("source"),
  "merge.base_loop_without_area": () => inGraft("Base"),
  "merge.base_misses_source": () => inGraft("Base"),
  "merge.base_takes_much": () => inGraft("Base"),
  "merge.base_tilt_too_large": () => inGraft("Base tilt"),
  "merge.boundary_touches_itself": ({ side }) => mend(side),
  "merge.component_without_pair": showLoops,
  "merge.dropped_source_inverted": () => inGraft("Size"),
  "merge.fixed_while_pose_found": () => inGraft("Placement"),
  "merge.laid_on_another_side": () => inGraft("Size"),
  "merge.loop_crosses_itself": () => cutOpen("source"),
  "merge.loop_named_twice": showLoops,
  "merge.loop_without_area": () => cutOpen("source"),
  "merge.loop_without_length": ({ side }) => mend(side),
  "merge.loops_differ": showLoops,
  "merge.loops_meet": showLoops,
  "merge.no_base": () => cutOpen("source"),
  "merge.no_boundary_loop": ({ side }) => cutOpen(side),
  "merge.no_loop_named": showLoops,
  "merge.no_pairs": showLoops,
  "merge.pieces_scaled_apart": () => inGraft("Size"),
  "merge.retried_in_vain": () => inGraft("Twist"),
  "merge.ring_not_removable": () => mend("target"),
  "merge.seam_faulty": () => inGraft("Twist"),
  "merge.seam_meets_surface": () => inGraft("Size"),
  "merge.seam_vertex_not_finite": () => mend("target"),
  "merge.source_inverted": () => inGraft("Twist"),
  "merge.source_reaches_in": () => inGraft("Spin"),
  "merge.source_squeezed": () => inGraft("Size"),
  "merge.start_unsure": () => inGraft("Twist"),
  "merge.vertex_not_on_boundary": showLoops,
  "merge.vertices_of_two_loops": showLoops,

  "mesh.cap_inside_out": (_, refused) => mendObject(refused),
  "mesh.cap_needs_plane": () => ({
    label: "Cut by a plane",
    run: ({ graft }) => {
      graft.mode.value = "graft";
      graft.tool.value = "plane";
    },
  }),
  "mesh.cap_outline_branches": (_, refused) => mendObject(refused),
  "mesh.cap_outline_crosses": (_, refused) => closeCut(refused, "Leave the cut open", "open"),
  "mesh.cap_outline_open": (_, refused) => mendObject(refused, "closeHoles"),
  "mesh.face_index_out_of_range": (_, refused) => mendObject(refused),
  "mesh.index_out_of_range_within_reach": (_, refused) => mendObject(refused),
  "mesh.loop_crosses_itself": drawAgain,
  "mesh.loop_does_not_part": () => ({ label: "Split, keep both", run: ({ graft }) => graft.cut("both") }),
  "mesh.loop_encloses_nothing": drawAgain,
  "mesh.loop_repeats_vertex": drawAgain,
  "mesh.loop_too_short": drawAgain,
  "mesh.loop_touches_boundary": drawAgain,
  "mesh.no_path": drawAgain,
  "mesh.no_room_for_pins": (_, refused) => closeCut(refused, "Close it flat", "flat"),
  "mesh.non_finite_within_reach": (_, refused) => mendObject(refused),
  "mesh.outlying_vertex_within_reach": (_, refused) => mendObject(refused),
  "mesh.pins_do_not_fit": (_, refused) => closeCut(refused, "Use automatic sizes", "pins"),
  "mesh.plane_misses_mesh": () => show("Show Offset", { mode: "graft", control: "Offset" }),
  "mesh.repair_unfinished": () => ({
    label: "Mend once more",
    run: ({ mending }) => mending.mendAll(mending.defective.value.map(({ name }) => name)),
  }),
  "mesh.vertex_not_finite": (_, refused) => mendObject(refused),

  "script.drop_intersects": () => inGraft("Spin"),
  "script.graft_intersects": () => inGraft("Twist"),
  "script.fixed_with_found_pose": () => inGraft("Placement"),
  "script.handle_empty": ({ handle }) => removeHandle(handle),
  "script.handle_not_finite": (_, refused) => mendObject(refused),
  "script.handle_outside_region": () => show("Show the handles", { mode: "deform", section: "Handles" }),
  "script.image_off_surface": () => inSymmetry("Across"),
  "script.image_with_gaps": ({ tolerance_rel }) => tolerate(tolerance_rel),
  "script.loop_on_non_manifold_edge": (_, refused) => mendObject(refused),
  "script.loop_on_non_manifold_vertex": (_, refused) => mendObject(refused),
  "script.loop_wound_inconsistently": (_, refused) => mendObject(refused),
  "script.match_of_no_pair": showLoops,
  "script.mirror_image_fixed": symmetryOff,
  "script.mirror_image_held": ({ other }) => removeHandle(other),
  "script.mirrored_curve_returns": () => inSymmetry("Tolerance"),
  "script.no_faces_left": showSteps,
  "script.no_mirror_image": ({ tolerance_rel }) => tolerate(tolerance_rel),
  "script.not_mirrored": () => inSymmetry("Across"),
  "script.not_one_vertex": () => take("vertex", "Point handle"),
  "script.not_settled": () => moreSettings("Iterations"),
  "script.overlaps_mirror_image": () => inSymmetry("Offset"),
  "script.pairs_unclear": showLoops,
  "script.pinched": showReach,
  "script.proxy_for_memory": showProxy,
  "script.proxy_solved": showProxy,
  "script.region_not_mirrored": () => inSymmetry("Across"),
  "script.region_without_mirror_image": ({ tolerance_rel }) => tolerate(tolerance_rel),
  "script.side_without_closed_loop": ({ side }) => mend(side),
  "script.side_without_loop": ({ side }) => cutOpen(side),
  "script.source_loop_unclear": showLoops,
  "script.strict_drop_intersects": () => inGraft("Spin"),
  "script.strict_graft_intersects": () => inGraft("Twist"),
  "script.vertex_not_mirrored": () => inSymmetry("Across"),
  "script.vertex_without_mirror_image": ({ tolerance_rel }) => tolerate(tolerance_rel),
  "script.welded": () => changeSettings("Switch off Weld seams", { weld: false }),
};

/** Holds the remedies of what the page notes itself. */
export const remedyOfPage = {
  library: showLibrary(),
  parts: showParts(),
  steps: showSteps(),
  symmetry: inSymmetry("Symmetric editing"),
} as const satisfies Record<string, Remedy>;
export type PageRemedy = keyof typeof remedyOfPage;

/** Changes the graft that is edited, or asks again for the one that was refused. */
function changeGraft(editor: Editor, fields: GraftFields, refused: Refused): unknown {
  if (refused?.do === "graft" && !editor.graft.isEdited.value) return editor.ask({ ...refused, ...fields });
  return editor.graft.set(fields);
}

/** Returns what the page can do about a fact; undefined if it can do nothing. `refused`: the request that it refused. */
export function remedyOf({ id, fields }: { id: string; fields: object }, refused?: PageRequest): Remedy | undefined {
  const inPanel = graftRemedy({ id, fields });
  if (inPanel !== undefined) return { label: inPanel.label, run: (editor) => changeGraft(editor, inPanel.fields, refused) };
  const remedy = (remedies as Record<string, ((fields: object, refused: Refused) => Remedy | undefined) | undefined>)[id];
  return remedy?.(fields, refused);
}
