import type { FactFields, FactId } from "../facts";
import type { EngineError, Note } from "../protocol";
import { baseWords } from "./graft/base_words";
import { methods, settingsTable } from "./method_settings";
import { counted, formatNumber } from "./units";

/** The content of a message to the user. Location and remedy may be empty. */
export interface Told {
  problem: string;
  location: string;
  remedy: string;
}

/** An error that the page finds by itself, such as a lost connection. It is not one of the engine's facts. */
export interface PageError extends Told {
  code: EngineError["code"];
}

/** The reason why a request failed. */
export type Failure = EngineError | PageError;

/** The page's words for a fact. Absent texts are those of the engine. A note with words has its problem at least. */
interface FactText {
  problem?: string;
  remedy?: string;
}

/** Returns what to tell the user of an error of the engine. */
export function inPanelWords(error: EngineError): Told {
  const { problem = error.problem, remedy = error.remedy } = textFor(error) ?? {};
  const reasons = error.notes.map(noteWords);
  return { problem, location: locationOf(error), remedy: [...reasons, remedy].filter((text) => text !== "").join(" ") };
}

/** Returns what to tell the user of a failed request. */
export function toldOf(failure: Failure): Told {
  return "id" in failure ? inPanelWords(failure) : failure;
}

/** Returns what to tell the user of a note, in a problem and a remedy where the page has words for it. */
export function toldOfNote(note: Note): Told {
  const { problem = note.text, remedy = "" } = textFor(note) ?? {};
  return { problem, location: "", remedy };
}

/** Returns a note as one or more sentences. */
export function noteWords(note: Note): string {
  const { problem, remedy } = toldOfNote(note);
  const text = sentence(problem);
  const ended = text.endsWith(".") || text.endsWith("?") ? text : `${text}.`;
  return remedy === "" ? ended : `${ended} ${remedy}`;
}

/** Begins a text with a capital letter. */
export function sentence(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** Returns the fields of a failure if it is this fact. */
export function fieldsOf<Id extends FactId>(failure: Failure, id: Id): FactFields[Id] | undefined {
  return "id" in failure && failure.id === id ? (failure.fields as unknown as FactFields[Id]) : undefined;
}

/** Returns the file that a request would have replaced, if it was refused for that. */
export function fileToReplace(failure: Failure): string | undefined {
  return (fieldsOf(failure, "io.file_exists") ?? fieldsOf(failure, "editor.file_changed"))?.file;
}

function textFor({ id, fields }: { id: string; fields: object }): FactText | undefined {
  const word = (words as Record<string, ((fields: object) => FactText) | undefined>)[id];
  return word?.(fields);
}

/** Returns where the error lies, in the page's words. Steps and pairs are counted from 1, as in the panels. */
function locationOf({ id, step, handle, pair, file }: EngineError): string {
  if (withoutLocation.has(id)) return "";
  const parts = [
    step !== undefined && `Step ${step + 1}`,
    handle !== undefined && `“${handle}”`,
    pair !== undefined && `Pair ${pair + 1}`,
    file !== undefined && `The file ${file}`,
  ];
  return parts.filter((part) => part !== false).join(", ");
}

/** Facts whose words name their location. */
const withoutLocation: ReadonlySet<string> = new Set<FactId>([
  "script.mirrored_curve_returns",
  "script.no_mirror_image",
  "script.not_mirrored",
  "script.overlaps_mirror_image",
  "script.vertex_not_mirrored",
  "script.vertex_without_mirror_image",
]);

/** Names the mesh of a graft as the panels do. The model is what the part is grafted onto. */
function sideWord(side: "source" | "target"): string {
  return side === "source" ? "part" : "model";
}

/** Names a method of the edit file as the panel does. */
function methodWord(name: string): string {
  return methods.find(({ value }) => value === name)?.label ?? name;
}
/** Names a setting of the edit file, or a choice of one, as the panel does. */
function settingWord(name: string): string {
  const choices = settingsTable.flatMap((setting) => (setting.kind === "choice" ? setting.choices : []));
  const found = settingsTable.find(({ key }) => key === name) ?? choices.find(({ value }) => value === name);
  return found?.label ?? name.replaceAll("_", " ");
}

function loopSizes(loops: number, sizes: readonly number[]): string {
  const more = sizes.length < loops ? ["…"] : []; // the engine lists the first ones
  return `${counted(loops, "loop")} (of ${[...sizes, ...more].join(", ")} vertices)`;
}

function lackWords({ lost, all }: { lost: number; all: number }, of: string): string {
  const who = lost === all ? (all === 1 ? "the vertex" : `all ${all} vertices`) : `${lost} of the ${all} vertices`;
  return `${who} of ${of} ${lost === 1 ? "lacks" : "lack"} a mirror image`;
}

function regionLacks(vertices: { lost: number; all: number }): string {
  return `${lackWords(vertices, "the region")}, so there the result is not symmetric`;
}

function imagesOff({ lost, all }: { lost: number; all: number }): string {
  const images = lost === 1 ? "the mirror image of 1" : `the mirror images of ${lost}`;
  return `${images} of the region's ${counted(all, "vertex", "vertices")} ${lost === 1 ? "is" : "are"} off the surface`;
}

const otherPlane =
  "The model is not the same on both sides of this plane. Move the plane, or choose another axis, under Symmetry.";
const turnInsideOut = "Switch on Flip normals of part, under More options.";
const percent = (part: number) => `${formatNumber(100 * part)} %`;
const elsewhere = "Drag it to another place.";
const smallerOrProxy = "Choose a smaller region, or set Proxy vertices under More settings.";

const together = { point: "in one place", line: "on one line", plane: "in one plane" };
const curves = { curve: "curve", closed_curve: "closed curve" };
const paths = { path: "path", closed_path: "closed path" };

/** The page's words, where the engine's are not those of a window with panels. */
const words: { [Id in FactId]?: (fields: FactFields[Id]) => FactText } = {
  "editor.nothing_moved": () => ({
    problem: "nothing moved",
    remedy: "The selected area has this shape already, or lies at an open boundary, which stays.",
  }),
  "core.no_such_vertex": ({ vertex, count }) => ({
    problem: `vertex ${vertex} does not exist; the mesh has ${counted(count, "vertex", "vertices")}`,
    remedy: "",
  }),
  "core.not_finite": ({ what }) => (what === "target" ? { problem: "the place to move to is not finite" } : {}),
  "deform.axis_without_length": () => ({
    problem: "the rotation axis has no length",
    remedy: "Choose X, Y or Z, or type a direction such as 0, 0, 1.",
  }),
  "deform.component_held_by_positions": ({ count, vertex, shape }) => ({
    problem: `the free component with vertex ${vertex} (${counted(count, "vertex", "vertices")}) is held by points alone, which lie ${together[shape]}, so it could still rotate or shear`,
    remedy: "Paint a handle on it, select some of it and choose Make fixed, or add points until four are not in one plane.",
  }),
  "deform.component_not_held": ({ count, vertex }) => ({
    problem: `the free component with vertex ${vertex} (${counted(count, "vertex", "vertices")}) touches no handle and nothing that is fixed, so it could be anywhere`,
    remedy: "Paint a handle on it, select some of it and choose Make fixed, or take it out of the region.",
  }),
  "deform.curve_not_affine": () => ({ problem: "a redrawn curve has no single move, rotation and scale", remedy: "" }),
  "deform.curve_too_short": ({ count, kind, needed }) => ({
    problem: `the ${curves[kind]} has ${counted(count, "vertex", "vertices")}; it needs ${needed}`,
  }),
  "deform.feature_not_linear": () => ({ remedy: "" }),
  "deform.features_not_reduced": () => ({ remedy: "" }),
  "deform.frames_not_linear": () => ({
    problem: "this method does not follow the handles linearly",
    remedy: "Choose the method Linear.",
  }),
  "deform.handle_constrains_nothing": () => ({ problem: "the handle holds neither position nor rotation" }),
  "deform.no_proxy": ({ vertices }) => ({
    problem: `no simplified mesh of about ${counted(vertices, "vertex", "vertices")} can be solved for this region`,
    remedy: "Raise Proxy vertices under More settings, or set it to 0 to solve the surface itself.",
  }),
  "deform.not_a_curve": () => ({ problem: "the handle is not a curve and cannot be redrawn" }),
  "deform.nothing_free": () => ({
    problem: "nothing is free to move",
    remedy: "Make the region larger, or the handles and the fixed area smaller.",
  }),
  "deform.vertex_of_two_handles": ({ vertex, handle }) => ({ problem: `vertex ${vertex} is already part of “${handle}”` }),
  "select.box_reversed": () => ({ problem: "the lower corner of the box lies above its upper corner" }),
  "select.no_such_component": ({ number, count }) => ({
    problem: `there is no connected piece ${number + 1}; the mesh has ${count}`,
  }),
  "select.no_such_loop": ({ number, count }) => ({
    problem: `there is no boundary loop ${number + 1}; the mesh has ${count}`,
  }),
  "select.path_crosses_itself": ({ vertex }) => ({
    problem: `the curve passes vertex ${vertex} twice`,
    remedy: "Click points that lie apart, in order along the curve.",
  }),
  "select.path_too_short": ({ kind, needed, count }) => ({
    problem: `a ${paths[kind]} needs ${needed} points near different vertices, here are ${count}`,
    remedy: "Click more points, farther apart.",
  }),
  "deform.proxy_solution_not_finite": () => ({
    problem: "the preview cannot be computed: the solution is not finite",
    remedy: "Undo, and move the handle by less.",
  }),
  "deform.solution_not_finite": ({ vertex }) => ({
    problem: `the result cannot be computed: the solution is not finite at vertex ${vertex}`,
    remedy: "Undo, and move the handle by less.",
  }),
  "deform.vertex_not_finite": () => ({ remedy: "Mend the model, or choose a region away from that vertex." }),
  "deform.solve_exceeds_memory": () => ({ remedy: smallerOrProxy }),

  "editor.defects": ({ file }) => ({
    problem: `the file ${file} has defects that can disturb editing`,
    remedy: "Defects, at the right, shows and mends them.",
  }),
  "editor.edit_without_file": () => ({ remedy: "Choose Save as…, in the menu at the top left." }),
  "editor.fields_without_use": () => ({ problem: "a graft that is cancelled or swapped changes in no other way" }),
  "editor.handle_follows": ({ handle, leader }) => ({
    problem: `“${handle}” is the mirror image of “${leader}”`,
    remedy: `Drag “${leader}”, or switch the symmetry off.`,
  }),
  "editor.id_unusable": () => ({ problem: "the page sent what the program does not understand" }),
  "editor.input_of_edit": () => ({ problem: "the edit begins with this file, so it cannot be replaced" }),
  "editor.faces_change": () => ({ remedy: "Switch off As a morph target." }),
  "editor.graft_side_missing": () => ({
    problem: "a graft needs a part and a model",
    remedy: "Click a loop of the model and a loop of the part.",
  }),
  "editor.handle_without_reach": ({ handle }) => ({
    problem: `“${handle}” has no reach of its own`,
    remedy: "Select what should follow it, and choose Make region.",
  }),
  "editor.ended_in_step": ({ step }) => ({
    problem: `meshgraft ended while it ran step ${step}, so your work was restored up to the step before`,
    remedy: "Continue from here, or undo once to bring the missing steps back and run them again.",
  }),
  "editor.journal_not_written": ({ reason }) => ({
    problem: `changes can no longer be saved to disk as you make them: ${reason}`,
  }),
  "editor.no_folder": () => ({ remedy: "Add a folder first." }),
  "editor.no_graft_to_resume": () => ({ remedy: "Choose a graft under Steps." }),
  "editor.no_handle_in_step": ({ step, handle }) => ({ problem: `step ${step} has no handle named “${handle}”` }),
  "editor.no_part": () => ({ remedy: "Add one from the part library." }),
  "editor.no_pictures": () => ({ remedy: "" }),
  "editor.only_step": () => ({ remedy: "Change it, or undo it." }),
  "editor.part_unclear": ({ count }) => ({
    problem: `it is unclear which of the ${counted(count, "part")} to graft`,
    remedy: "Click one under Parts, or click one of its loops.",
  }),
  "editor.size_not_shown": ({ file, reach, size, low, high }) => ({
    problem: `the file ${file} cannot be shown: its coordinates reach ${formatNumber(reach, 3)} and its size is ${formatNumber(size, 3)}`,
    remedy: `Scale it to sizes between ${formatNumber(low, 3)} and ${formatNumber(high, 3)}.`,
  }),
  "editor.path_not_full": () => ({
    problem: "this is not the full path of a folder",
    remedy: "Begin at the root or at your home, such as /home/me/models or ~/models.",
  }),
  "editor.no_such_request": () => ({ problem: "the page asked for what the program does not know" }),
  "editor.selected_elsewhere": ({ on, wanted }) => ({
    problem: `the selection lies on ${on}`,
    remedy: `Select on ${wanted}.`,
  }),
  "editor.outside_folders": () => ({
    remedy: "Drop the file on the window, or add its folder where you choose files.",
  }),
  "editor.too_many_requests": () => ({
    problem: "too many changes are waiting",
    remedy: "Wait a moment, and try again.",
  }),

  "io.file_exists": () => ({ remedy: "Choose another name, or replace it." }),
  "io.no_morph_targets": () => ({ remedy: "Choose glTF as the format." }),
  "io.other_format": ({ file, format, named }) => ({
    problem: `the file ${file} holds ${format}, not ${named}`,
    remedy: `It was opened as ${format}. An export under this name is written as ${named}.`,
  }),

  "linalg.matrix_too_large": () => ({ remedy: smallerOrProxy }),
  "linalg.no_multifrontal_solver": () => ({ remedy: "Choose another Solver under More settings." }),
  "linalg.no_room_for_buffers": ({ megabytes }) => ({
    problem: `there is not enough memory: ${megabytes} MB are missing`,
    remedy: "Close other programs, or choose a smaller region.",
  }),
  "linalg.not_converged": () => ({
    remedy: "Choose another Solver under More settings or a smaller region, or repair needle-like triangles.",
  }),
  "linalg.not_positive_definite": () => ({
    problem: "the equations cannot be solved: they are not positive definite",
    remedy: "Hold more of the surface, or choose another setting of Flat areas, under More settings.",
  }),
  "linalg.operator_too_large": () => ({ remedy: smallerOrProxy }),

  ...baseWords,
  "merge.bent_less": ({ normal_angle_deg }) => ({
    problem: `the part turned inside out or shrank where its boundary bends into the surface, so it bends less: a tilt of ${formatNumber(normal_angle_deg, 4, 0)}° was used`,
  }),
  "merge.boundary_ragged": ({ pair, turn_deg }) => ({
    problem: `a loop of pair ${pair + 1} is ragged (it turns by ${formatNumber(turn_deg, 4, 0)}° per vertex too much)`,
    remedy: "Switch on Smooth ragged loops, under More options.",
  }),
  "merge.boundary_touches_itself": ({ side, vertex }) => ({
    problem: `the ${sideWord(side)}'s boundary touches itself in vertex ${vertex}`,
    remedy: `Cancel the graft and mend the ${sideWord(side)}.`,
  }),
  "merge.component_without_pair": ({ vertices }) => ({
    problem: `a piece of the part has no paired loop yet (${counted(vertices, "vertex", "vertices")})`,
    remedy: "Click one of its loops and the loop of the model to join to it.",
  }),
  "merge.dropped_pose_kept": () => ({ problem: "a part that is dropped has no pose to keep", remedy: "" }),
  "merge.dropped_source_inverted": ({ vertices, size }) => ({
    problem: `the part turns inside out at ${counted(vertices, "vertex", "vertices")} beside the hole, at size ${formatNumber(size, 3)}`,
    remedy: "Drag it to another place, or choose a smaller size.",
  }),
  "merge.fixed_on_loop": () => ({
    problem: "the fixed area includes the part's loop, which moves to the model's",
    remedy: "Leave the loop out of the fixed area, or choose Clear fixed area.",
  }),
  "merge.fixed_while_pose_found": () => ({ remedy: "Set Placement to Manual." }),
  "merge.hole_not_manifold": ({ vertex, other_vertex, size }) => ({
    problem: `the model is not an oriented manifold within the hole, at edge ${vertex}–${other_vertex}, at size ${formatNumber(size, 3)}`,
  }),
  "merge.loop_crosses_itself": ({ vertex }) => ({
    problem: `the part's loop at vertex ${vertex} crosses itself as seen along its axis`,
    remedy: "Cut the part again, along a simpler curve.",
  }),
  "merge.loop_larger_than_target": ({ size }) => ({
    problem: `the part's loop is larger than the model, at size ${formatNumber(size, 3)}`,
  }),
  "merge.loop_length_out_of_range": ({ side, vertex, length, coordinate }) => ({
    problem: `the ${sideWord(side)}'s loop at vertex ${vertex} is ${formatNumber(length, 2)} long in coordinates up to ${formatNumber(coordinate, 2)}`,
  }),
  "merge.loop_named_twice": ({ pair, other_pair, side, vertex }) => ({
    problem: `pairs ${pair + 1} and ${other_pair + 1} have the same loop of the ${sideWord(side)} (vertex ${vertex})`,
  }),
  "merge.loop_not_listed_in_order": ({ side }) => ({ problem: `the ${sideWord(side)}'s loop is not listed in its order` }),
  "merge.loop_not_listed_whole": ({ listed, side, count }) => ({
    problem: `${listed} of the ${count} vertices of the ${sideWord(side)}'s boundary loop are listed`,
  }),
  "merge.loop_rounded_off": () => ({
    problem: "the part's loop crosses itself as seen along its axis; the hole is rounded off",
  }),
  "merge.loop_smaller_than_faces": ({ size }) => ({
    problem: `the loop is too small for the model's faces, at size ${formatNumber(size, 3)}`,
  }),
  "merge.loop_without_area": ({ vertex }) => ({
    problem: `the part's loop at vertex ${vertex} spans no area`,
    remedy: "Cut the part where the loop is open like a ring.",
  }),
  "merge.loop_without_length": ({ side, vertex }) => ({
    problem: `the ${sideWord(side)}'s loop at vertex ${vertex} has no length`,
    remedy: `Cancel the graft and mend the ${sideWord(side)}: all vertices of the loop are in one place.`,
  }),
  "merge.seam_vertex_not_finite": () => ({ remedy: "Cancel the graft and mend the model." }),
  "merge.loops_differ": ({ pair, difference_percent, bend_deg }) => ({
    problem: `the loops of pair ${pair + 1} differ in shape (by ${formatNumber(difference_percent, 4, 0)} % of their radius on average), so the seam is bent by ${formatNumber(bend_deg, 4, 0)}°`,
    remedy: "Double-click a loop to match more points, or cut loops that are more alike.",
  }),
  "merge.loops_meet": ({ pair, vertex }) => ({
    problem: `the loop meets that of pair ${pair + 1} in vertex ${vertex}`,
    remedy: "Pair loops that do not touch.",
  }),
  "merge.match_not_on_loop": ({ side, vertex }) => ({
    problem: `vertex ${vertex} of the ${sideWord(side)} is not on the pair's loop`,
    remedy: "Match points of the two loops.",
  }),
  "merge.matches_cross": ({ source, next_source, target, next_target }) => ({
    problem: `the matches cross: vertices ${source} and ${next_source} of the part follow one another, vertices ${target} and ${next_target} of the model do not`,
    remedy: `Drag the markers into the same order. Do the normals of the part point inward? ${turnInsideOut}`,
  }),
  "merge.no_boundary_loop": ({ side }) => ({
    problem: `the ${sideWord(side)} has no boundary loop, its surface is closed`,
    remedy:
      side === "source"
        ? "Cut it open first."
        : "Cut it open first, or drop the part on its surface.",
  }),
  "merge.no_colours_to_blend": () => ({ problem: "neither the model nor the part has vertex colours to blend" }),
  "merge.no_hole": ({ largest }) => ({
    remedy: `Use a size of at most ${formatNumber(largest, 3)}, or drag it to another place.`,
  }),
  "merge.no_hole_at_any_size": () => ({ remedy: elsewhere }),
  "merge.no_loop_named": ({ side }) => ({ problem: `no loop of the ${sideWord(side)} is paired` }),
  "merge.no_pairs": () => ({
    problem: "no loops are paired",
    remedy: "Click a loop of the model and a loop of the part.",
  }),
  "merge.no_such_surface_vertex": ({ vertex, count }) => ({
    problem: `vertex ${vertex} of the model does not exist; it has ${count}`,
    remedy: elsewhere,
  }),
  "merge.no_such_vertex": ({ side, vertex, count }) => ({
    problem: `vertex ${vertex} of the ${sideWord(side)} does not exist; it has ${count}`,
  }),
  "merge.orientations_disagree": ({ inward, outward }) => ({
    problem: `the faces of the ${sideWord(inward)} point inward, those of the ${sideWord(outward)} outward, so the two loops do not fit`,
    remedy: turnInsideOut,
  }),
  "merge.pairs_invert_source": ({ pair, radii, vertices }) => ({
    problem: `the part's loops lie differently from the model's: placed as well as can be, those of pair ${pair + 1} are still ${formatNumber(radii, 2)} times their radius apart, and the part turns inside out at ${counted(vertices, "vertex", "vertices")}`,
    remedy: "Pair fewer loops, or others, or keep the first try all the same.",
  }),
  "merge.point_off_surface": ({ x, y, z, distance }) => ({
    problem: `the point (${[x, y, z].map((at) => formatNumber(at, 6)).join(", ")}) is ${formatNumber(distance)} away from the model's surface`,
    remedy: "Drag the part onto the surface.",
  }),
  "merge.result_not_manifold": () => ({
    problem: "the result is not a manifold; perhaps one of the two meshes was not",
  }),
  "merge.ring_not_removable": () => ({
    problem: "the ring of faces at the model's loop cannot be taken away without cutting off more",
    remedy: "Cancel the graft and mend the model: it is not an oriented manifold there.",
  }),
  "merge.pieces_scaled_apart": ({ least, most }) => ({
    problem: `the pieces of the part take the sizes of their loops: they are scaled by ${formatNumber(least, 3)} to ${formatNumber(most, 3)}`,
    remedy: "A size of your choice scales all alike.",
  }),
  "merge.retried": ({ faults_before, faults, tries }) => ({
    problem: `the first try had ${counted(faults_before, "fault")} at the seam (inverted, folded or intersecting faces), this one has ${faults}; ${tries} were tried`,
  }),
  "merge.retried_in_vain": ({ faults, tries }) => ({
    problem: `${counted(tries, "other graft was", "other grafts were")} tried, and none has fewer faults at the seam than ${faults}`,
    remedy: "Twist the part, or cut loops that are more alike.",
  }),
  "merge.seam_faulty": ({ folded_edges, crossings }) => ({
    problem: `at the seam ${counted(folded_edges, "edge")} fold over and ${counted(crossings, "pair")} of faces intersect; loops that are more alike may help`,
  }),
  "merge.seam_meets_surface": ({ pairs }) => ({
    problem: `${counted(pairs, "pair")} of faces at the seam intersect the surface elsewhere: the part is longer than the room there; a smaller size may help`,
  }),
  "merge.size_makes_source_huge": ({ size }) => ({
    problem: `size ${formatNumber(size, 3)} makes the part over a million times larger than the model`,
  }),
  "merge.size_makes_source_tiny": ({ size }) => ({
    problem: `size ${formatNumber(size, 3)} makes the part over a million times smaller than the model`,
  }),
  "merge.size_too_small": ({ size }) => ({
    problem: `the part's loop would be less than a millionth of the model's size at ${formatNumber(size, 3)}`,
  }),
  "merge.intersection_avoided_if_smaller": ({ size, smaller_size }) => ({
    problem: `the part reaches into the model at size ${formatNumber(size, 3)}; at ${formatNumber(smaller_size, 3)} it does not`,
  }),
  "merge.source_stretched": ({ pair, radii }) => ({
    problem: `the part's loop of pair ${pair + 1} is ${formatNumber(radii, 3)} times the radius of the model's away, and the part is stretched that far`,
    remedy: "Set Placement to Automatic to bring it there.",
  }),
  "merge.source_inverted": ({ vertices }) => ({
    problem: `the part turns inside out at ${counted(vertices, "vertex", "vertices")}; another rotation or more matches may help`,
  }),
  "merge.source_matched_twice": ({ source, target, other_target }) => ({
    problem: `vertex ${source} of the part is matched with two vertices of the model, ${target} and ${other_target}`,
  }),
  "merge.source_reaches_in": () => ({ problem: "the part reaches into the model; another spin or place may help" }),
  "merge.source_scaled": ({ size }) => ({ problem: `the part is scaled by ${formatNumber(size, 3)}` }),
  "merge.source_scaled_to_graft": ({ size }) => ({
    problem: `the part is scaled by ${formatNumber(size, 3)}: larger, it turns inside out or cuts into the model`,
  }),
  "merge.source_shrunk": ({ percent }) => ({
    problem: `the part ends with ${formatNumber(percent, 2, 0)} % of the size that its loops ask for`,
    remedy: "A tilt of -45° bends its boundary less. A size of your choice may help, too.",
  }),
  "merge.source_squeezed": ({ width_percent }) => ({
    problem: `the part is squeezed to ${formatNumber(width_percent, 4, 0)} % of its width near the seam; a size of your choice or a finer part may help`,
  }),
  "merge.source_too_small": ({ least }) => ({
    problem: "the part's loop is less than a millionth of the model's size",
    remedy: `Are their units different? Choose a size of ${formatNumber(least, 2)} or more.`,
  }),
  "merge.source_would_reach_in": ({ size }) => ({
    problem: `the part would reach into the model, at size ${formatNumber(size, 3)}`,
  }),
  "merge.start_unsure": ({ pair, percent }) => ({
    problem: `rotation of pair ${pair + 1} unclear: the one shown is a guess (${formatNumber(percent, 3, 0)} %)`,
    remedy: "If it is wrong, choose another one under Pairs, or use Twist.",
  }),
  "merge.target_matched_twice": ({ source, other_source, target }) => ({
    problem: `vertices ${source} and ${other_source} of the part are matched with the same vertex of the model, ${target}`,
    remedy: "Keep one of the two.",
  }),
  "merge.target_without_faces": () => ({ problem: "the model has no faces" }),
  "merge.too_few_pairs": ({ count }) => ({ problem: `three matched points place a part, here are ${count}` }),
  "merge.transform_flattens": () => ({ problem: "the pose flattens the part" }),
  "merge.vertex_not_finite": ({ side, vertex }) => ({
    problem: `vertex ${vertex} of the ${sideWord(side)} has no finite position`,
  }),
  "merge.vertex_not_on_boundary": ({ side, vertex }) => ({
    problem: `vertex ${vertex} of the ${sideWord(side)} is not on a boundary`,
    remedy: "Click a boundary loop.",
  }),
  "merge.vertex_on_boundary": ({ vertex }) => ({
    problem: `vertex ${vertex} of the model is on the boundary`,
    remedy: "Drag it farther inside, or pair the loop there with a loop of the part.",
  }),
  "merge.vertex_without_face": ({ vertex }) => ({
    problem: `vertex ${vertex} of the model belongs to no face`,
    remedy: elsewhere,
  }),
  "merge.vertices_of_two_loops": ({ side, vertex, other_vertex }) => ({
    problem: `vertices ${vertex} and ${other_vertex} of the ${sideWord(side)} are on two boundary loops`,
    remedy: "Click one loop.",
  }),
  "merge.vertices_on_a_line": ({ side }) => ({
    problem: `the matched points of the ${sideWord(side)} lie on a line, so any rotation about it fits`,
  }),

  "mesh.cap_inside_out": () => ({
    problem: "the cut cannot be closed: the mesh faces inward there",
    remedy: "Mend the mesh and close its holes first, or leave the cut open.",
  }),
  "mesh.cap_needs_plane": () => ({
    problem: "only a cut by a plane can be closed",
    remedy: "Cut by a plane, or leave the cut open.",
  }),
  "mesh.cap_outline_branches": () => ({
    problem: "the cut cannot be closed: it meets an edge of three or more faces",
    remedy: "Mend the mesh first, or leave the cut open.",
  }),
  "mesh.cap_outline_crosses": () => ({
    problem: "the cut cannot be closed: its outline crosses or touches itself",
    remedy: "Move the plane a little, or leave the cut open.",
  }),
  "mesh.cap_outline_open": () => ({
    problem: "the cut cannot be closed: it meets a hole of the mesh",
    remedy: "Close the holes of the mesh first, or leave the cut open.",
  }),
  "mesh.no_room_for_pins": () => ({
    problem: "no pin fits: the model is too thin behind the cut",
    remedy: "Move the plane to where the model is thicker, put the pins on the other side, or close the cut flat.",
  }),
  "mesh.pins_do_not_fit": () => ({
    problem: "no pin of this size fits",
    remedy: "Make the diameter or the length smaller, or switch on Automatic sizes.",
  }),
  "mesh.caps_without_pins": ({ count }) => ({
    problem: `${counted(count, "cut face has", "cut faces have")} no pins: there is no room for them`,
  }),
  "mesh.pins_left_out": ({ count }) => ({
    problem: `${counted(count, "pin was", "pins were")} left out: there is no room for so many`,
  }),
  "mesh.pins_shortened": ({ count }) => ({
    problem: `${counted(count, "pin was", "pins were")} made shorter: the model is too thin for more`,
  }),
  "mesh.degenerate_face": ({ count }) => ({ problem: counted(count, "face with a corner twice", "faces with a corner twice") }),
  "mesh.duplicate_face": ({ count }) => ({ problem: counted(count, "face that lies on another", "faces that lie on others") }),
  "mesh.inconsistent_winding": ({ count }) => ({
    problem: counted(count, "edge between faces that face opposite ways", "edges between faces that face opposite ways"),
  }),
  "mesh.index_out_of_range": ({ count }) => ({
    problem: counted(count, "face with a missing vertex", "faces with a missing vertex"),
  }),
  "mesh.inward_facing_component": ({ count }) => ({
    problem: counted(count, "closed piece that is inside out", "closed pieces that are inside out"),
  }),
  "mesh.isolated_vertex": ({ count }) => ({ problem: counted(count, "loose vertex of no face", "loose vertices of no face") }),
  "mesh.non_finite": ({ count }) => ({
    problem: counted(count, "vertex without a position", "vertices without a position"),
  }),
  "mesh.non_manifold_edge": ({ count }) => ({
    problem: counted(count, "edge with more than two faces", "edges with more than two faces"),
  }),
  "mesh.non_manifold_vertex": ({ count }) => ({
    problem: counted(count, "vertex where surfaces only touch", "vertices where surfaces only touch"),
  }),
  "mesh.outlying_vertex": ({ count }) => ({
    problem: counted(count, "vertex far away from all others", "vertices far away from all others"),
  }),
  "mesh.too_large": ({ count }) => ({
    problem: counted(count, "vertex that is too far out", "vertices that are too far out"),
    remedy: "Scale the model down in another program.",
  }),
  "mesh.zero_area_face": ({ count }) => ({ problem: counted(count, "face without area", "faces without area") }),

  "mesh.filled_hole": ({ count }) => ({ problem: `${counted(count, "hole was", "holes were")} closed` }),
  "mesh.hole_beside_inconsistent_faces": ({ count }) => ({
    problem: `${counted(count, "hole was", "holes were")} not closed: the faces around do not fit together`,
  }),
  "mesh.hole_fill_intersects": ({ count }) => ({
    problem: `${counted(count, "triangle that closes a hole cuts", "triangles that close holes cut")} through the surface`,
    remedy: "Close these holes in another way, or shape the surface there.",
  }),
  "mesh.mended_degenerate_face": ({ count }) => ({
    problem: `${counted(count, "face with a corner twice was", "faces with a corner twice were")} mended or removed`,
  }),
  "mesh.one_sided_surface": ({ count }) => ({
    problem: `${counted(count, "edge keeps", "edges keep")} faces that face opposite ways: the surface has one side only, like a Möbius strip`,
  }),
  "mesh.rejoined_vertex": ({ count }) => ({ problem: `${counted(count, "vertex was", "vertices were")} joined again` }),
  "mesh.removed_debris": ({ count }) => ({ problem: `${counted(count, "crumb was", "crumbs were")} removed` }),
  "mesh.removed_duplicate_face": ({ count }) => ({
    problem: `${counted(count, "face that lay on another was", "faces that lay on others were")} removed`,
  }),
  "mesh.removed_duplicate_shell": ({ count }) => ({
    problem: `${counted(count, "piece that lay on another was", "pieces that lay on others were")} removed`,
  }),
  "mesh.removed_isolated_vertex": ({ count }) => ({
    problem: `${counted(count, "loose vertex was", "loose vertices were")} removed`,
  }),
  "mesh.removed_non_finite_face": ({ count }) => ({
    problem: `${counted(count, "face at a vertex without a position was", "faces at a vertex without a position were")} removed`,
  }),
  "mesh.removed_non_finite_vertex": ({ count }) => ({
    problem: `${counted(count, "vertex without a position was", "vertices without a position were")} removed`,
  }),
  "mesh.removed_non_manifold_face": ({ count }) => ({
    problem: `${counted(count, "face at an edge with more than two was", "faces at edges with more than two were")} removed`,
  }),
  "mesh.removed_out_of_range_face": ({ count }) => ({
    problem: `${counted(count, "face with a missing vertex was", "faces with a missing vertex were")} removed`,
  }),
  "mesh.repair_unfinished": () => ({ problem: "something is left to mend", remedy: "Mend once more." }),
  "mesh.split_non_manifold_vertex": ({ count }) => ({
    problem: `surfaces that only touched were taken apart at ${counted(count, "vertex", "vertices")}`,
  }),
  "mesh.split_t_junction": ({ count }) => ({
    problem: `${counted(count, "open edge was", "open edges were")} split at a vertex that lay on it`,
  }),
  "mesh.turned_component": ({ count }) => ({
    problem: `${counted(count, "piece that was inside out was", "pieces that were inside out were")} turned over`,
  }),
  "mesh.turned_face": ({ count }) => ({ problem: `${counted(count, "face was", "faces were")} turned over` }),
  "mesh.welded_vertex": ({ count }) => ({
    problem: `${counted(count, "vertex of an open seam was", "vertices of open seams were")} joined`,
  }),

  "mesh.faces_left_out": ({ mesh, count }) => ({
    problem: `${counted(count, "face")} of ${mesh} cannot be used and ${count === 1 ? "was" : "were"} left out`,
  }),
  "mesh.index_out_of_range_within_reach": ({ count }) => ({
    problem: `${counted(count, "face has", "faces have")} a corner that does not exist`,
    remedy: "Mend the mesh first.",
  }),
  "mesh.non_finite_within_reach": ({ count }) => ({
    problem: `${counted(count, "vertex has", "vertices have")} no position`,
    remedy: "Mend the mesh first: that removes them with their faces.",
  }),
  "mesh.outlying_vertex_within_reach": ({ count }) => ({
    problem: `${counted(count, "vertex lies", "vertices lie")} far beyond all others`,
    remedy: "Mend the mesh first: that removes them with their faces.",
  }),
  "mesh.face_index_out_of_range": () => ({ remedy: "Mend the mesh first." }),
  "mesh.vertex_not_finite": () => ({ remedy: "Mend the mesh first." }),
  "mesh.loop_crosses_itself": () => ({ remedy: "Draw again, so that the curve stays clear of itself." }),
  "mesh.loop_does_not_part": () => ({
    problem: "the curve does not divide the surface: there is no side to keep",
    remedy: "Choose Split, keep both: the cut opens the surface along two loops.",
  }),
  "mesh.loop_encloses_nothing": () => ({ remedy: "Draw again, farther around." }),
  "mesh.loop_repeats_vertex": ({ vertex }) => ({
    problem: `the curve passes vertex ${vertex} twice`,
    remedy: "Draw again, so that the curve stays clear of itself.",
  }),
  "mesh.loop_too_short": ({ count }) => ({
    problem: `the curve has ${counted(count, "vertex", "vertices")}; it needs three`,
    remedy: "Draw again, farther around.",
  }),
  "mesh.loop_touches_boundary": () => ({ remedy: "Draw the curve around it." }),
  "mesh.no_path": () => ({ remedy: "Draw on one connected piece." }),
  "mesh.plane_misses_mesh": () => ({ remedy: "Move the plane onto it." }),

  "script.at_with_kept_pose": () => ({ problem: "a part that is dropped goes where it is dropped, so its pose is not kept" }),
  "script.at_with_loops": ({ field }) => ({
    problem: `a part that is dropped opens a hole of its own, so it goes without '${field}'`,
  }),
  "script.drop_intersects": ({ pairs }) => ({
    problem: `the result has ${counted(pairs, "self-intersecting pair")} of faces; another place, spin or size may help`,
  }),
  "script.fixed_empty": () => ({
    problem: "the fixed area is empty",
    remedy: "Paint some of the part, or choose Clear fixed area.",
  }),
  "script.fixed_with_found_pose": () => ({ remedy: "Set Placement to Manual." }),
  "script.former_backend": ({ former, name }) => ({
    problem: `the solver ${former} of the edit file is called ${settingWord(name)} now, and that is what was used`,
  }),
  "script.former_setting": ({ former, name }) => ({
    problem: `the setting ${former} of the edit file is called ${settingWord(name)} now`,
  }),
  "script.graft_intersects": ({ pairs }) => ({
    problem: `the result has ${counted(pairs, "self-intersecting pair")} of faces; another rotation, size or shape may help`,
  }),
  "script.handle_empty": ({ handle }) => ({
    problem: `“${handle}” has no vertices`,
    remedy: "Select more for it, or remove the handle.",
  }),
  "script.handle_not_finite": ({ handle, vertex }) => ({
    problem: `“${handle}” has a vertex without a position, ${vertex}`,
    remedy: "Mend the model first.",
  }),
  "script.handles_with_found_pose": () => ({
    problem: "nothing can be held while the part's place is found",
    remedy: "",
  }),
  "script.handle_outside_region": ({ handle, outside, all }) => ({
    problem: `${outside} of the ${counted(all, "vertex", "vertices")} of “${handle}” lie outside the region`,
    remedy: "Make the region larger, or the handle smaller.",
  }),
  "script.loop_on_non_manifold_edge": ({ loop, mesh, count, vertices }) => ({
    problem: `loop ${loop + 1} of ${mesh} cannot be paired: ${counted(count, "edge has", "edges have")} more than two faces, on the loop, first at vertices ${vertices.join(", ")}`,
    remedy: "Mend the mesh first.",
  }),
  "script.loop_on_non_manifold_vertex": ({ loop, mesh, count, vertices }) => ({
    problem: `loop ${loop + 1} of ${mesh} cannot be paired: ${counted(count, "vertex joins", "vertices join")} separate fans of faces, on the loop, first at vertices ${vertices.join(", ")}`,
    remedy: "Mend the mesh first.",
  }),
  "script.loop_wound_inconsistently": ({ loop, mesh, count, vertices }) => ({
    problem: `loop ${loop + 1} of ${mesh} cannot be paired: ${counted(count, "edge has", "edges have")} two faces that are oriented inconsistently, on the loop, first at vertices ${vertices.join(", ")}`,
    remedy: "Mend the mesh first. A Möbius strip has no two sides: cut it open.",
  }),
  "script.match_of_no_pair": ({ target, source }) => ({
    problem: `a match joins loop ${target + 1} of the model and loop ${source + 1} of the part, which are no pair`,
    remedy: "Pair these two loops first.",
  }),
  "script.merge_without_shell": () => ({
    problem: `the part was joined by ${methodWord("corotational")}, because ${methodWord("shell")} would bend it beside the seam`,
  }),
  "script.mirror_image_fixed": ({ vertex, handle }) => ({
    problem: `vertex ${vertex} of the mirror image of “${handle}” is already fixed`,
    remedy: "Take what is there out of the fixed area, or switch the symmetry off.",
  }),
  "script.mirror_image_held": ({ vertex, handle, other }) => ({
    problem: `vertex ${vertex} of the mirror image of “${handle}” is already part of “${other}”`,
    remedy: `Symmetry mirrors the handle to the other side: remove “${other}”.`,
  }),
  "script.mirrored_curve": ({ handle }) => ({
    problem: `the curve “${handle}” became its own mirror image, which may also be half a rotation; its surroundings were rotated`,
  }),
  "script.mirrored_curve_returns": ({ handle }) => ({
    problem: `the mirror image of the curve “${handle}” passes a vertex twice`,
    remedy: "Make the tolerance smaller, under Symmetry, or draw the curve elsewhere.",
  }),
  "script.no_faces_left": () => ({ remedy: "Switch off what removes faces, at the step." }),
  "script.no_mirror_image": ({ handle, lost, all, tolerance_rel }) => ({
    problem: lackWords({ lost, all }, `“${handle}”`),
    remedy: `The model is not quite the same on both sides. A tolerance of ${percent(tolerance_rel)} suffices; or use another handle.`,
  }),
  "script.no_such_loop": ({ side, loop, loops, sizes }) => ({
    problem: `the ${sideWord(side)} has no boundary loop ${loop + 1}`,
    remedy: `It has ${loopSizes(loops, sizes)}.`,
  }),
  "script.no_such_vertex": ({ side, vertex, count, loops, sizes }) => ({
    problem: `the ${sideWord(side)} has no vertex ${vertex} among its ${count}`,
    remedy: `It has ${loopSizes(loops, sizes)}.`,
  }),
  "script.not_mirrored": ({ handle, lost, all }) => ({ problem: lackWords({ lost, all }, `“${handle}”`), remedy: otherPlane }),
  "script.not_one_loop": ({ side, count, loops, sizes }) => ({
    problem: `the ${count} selected vertices are not those of one boundary loop of the ${sideWord(side)}`,
    remedy: `It has ${loopSizes(loops, sizes)}.`,
  }),
  "script.not_one_vertex": ({ handle, count }) => ({
    problem: `the point handle “${handle}” has ${counted(count, "vertex", "vertices")} instead of one`,
    remedy: "Click one vertex with Point handle, or paint with Handle.",
  }),
  "script.not_settled": ({ iterations, change_deg }) => ({
    problem: `the surface had not settled after ${counted(iterations, "iteration")} (it would have rotated by another ${formatNumber(change_deg, 4, 1)}°)`,
    remedy: "Raise Iterations, under More settings, or rotate by less.",
  }),
  "script.overlaps_mirror_image": ({ handle, shared, all }) => ({
    problem: `“${handle}” overlaps its mirror image, in ${shared} of ${counted(all, "vertex", "vertices")}`,
    remedy: "Keep it on one side of the plane, or move the plane under Symmetry.",
  }),
  "script.pinched": ({ vertex, percent }) => ({
    problem: `at vertex ${vertex} the surface is ${formatNumber(percent, 2, 0)} % as wide as it was`,
    remedy: "A smaller rotation, or a longer Reach, keeps more of its width.",
  }),
  "script.pairs_unclear": ({ target_loops, target_sizes, source_loops, source_sizes }) => ({
    problem: `it is unclear which loops to join: the model has ${loopSizes(target_loops, target_sizes)}, the part ${loopSizes(source_loops, source_sizes)}`,
    remedy: "Click a loop of the model and the loop of the part to join to it.",
  }),
  "script.positions_stretch": ({ ratio }) => ({
    problem: `the handles give positions alone, which stretches the surface ${formatNumber(ratio, 3, 0)} times as much one way as another`,
    remedy: "Handles that rotate, or something fixed, keep its shape.",
  }),
  "script.posed_twice": () => ({
    problem: "the part is placed twice: by matched points, and by a pose of its own",
    remedy: "Keep one of the two.",
  }),
  "script.image_off_surface": ({ lost, all }) => ({ problem: imagesOff({ lost, all }), remedy: otherPlane }),
  "script.image_with_gaps": ({ lost, all, tolerance_rel }) => ({
    problem: imagesOff({ lost, all }),
    remedy: `A tolerance of ${percent(tolerance_rel)} suffices; or choose another plane, or switch Symmetry off.`,
  }),
  "script.region_not_mirrored": ({ lost, all }) => ({ problem: regionLacks({ lost, all }), remedy: otherPlane }),
  "script.region_without_mirror_image": ({ lost, all, tolerance_rel }) => ({
    problem: regionLacks({ lost, all }),
    remedy: `A tolerance of ${percent(tolerance_rel)}, under Symmetry, suffices.`,
  }),
  "script.setting_without_use": ({ method, setting }) => ({
    problem: `the method ${methodWord(method)} does not use the ${settingWord(setting)}, so that it changed nothing`,
  }),
  "script.shell_not_settled": ({ steps }) => ({
    problem: `the surface had not settled after ${counted(steps, "step")}`,
    remedy: "A smaller rotation or move bends more evenly.",
  }),
  "script.side_without_closed_loop": ({ side, mesh, edges, vertex }) => ({
    problem: `the ${sideWord(side)} (${mesh}) has no closed boundary loop: ${counted(edges, "edge has", "edges have")} more than two faces, first at vertex ${vertex}`,
    remedy: `Cancel the graft and mend the ${sideWord(side)}.`,
  }),
  "script.side_without_faces": ({ side, mesh }) => ({ problem: `the ${sideWord(side)} (${mesh}) has no faces` }),
  "script.side_without_loop": ({ side, mesh }) => ({
    problem: `the ${sideWord(side)} (${mesh}) has no boundary loop`,
    remedy:
      side === "source"
        ? "Drag it onto the surface, where it is opened by itself, or cut it open first."
        : "Cut it open first, or drop the part on its surface.",
  }),
  "script.size_with_kept_pose": () => ({ remedy: "Scale the part by its gizmo." }),
  "script.source_loop_unclear": ({ loops, sizes }) => ({
    problem: `it is unclear which loop of the part joins the surface: it has ${loopSizes(loops, sizes)}`,
    remedy: "Drop a part with one loop, or pair its loops with loops of the model.",
  }),
  "script.strict_drop_intersects": ({ pairs }) => ({
    problem: `${counted(pairs, "pair")} of faces of the result intersect`,
    remedy: "Another place, spin or size may help.",
  }),
  "script.strict_graft_intersects": ({ pairs }) => ({
    problem: `${counted(pairs, "pair")} of faces of the result intersect`,
    remedy: "Another rotation, size or shape may help.",
  }),
  "script.vertex_not_mirrored": ({ vertex }) => ({
    problem: `vertex ${vertex} lacks a mirror image`,
    remedy: otherPlane,
  }),
  "script.vertex_off_loops": ({ side, vertex, loops, sizes }) => ({
    problem: `vertex ${vertex} is not on a boundary of the ${sideWord(side)}`,
    remedy: `It has ${loopSizes(loops, sizes)}.`,
  }),
  "script.vertex_without_mirror_image": ({ vertex, tolerance_rel }) => ({
    problem: `vertex ${vertex} lacks a mirror image`,
    remedy: `The model is not quite the same on both sides. A tolerance of ${percent(tolerance_rel)} suffices; or use another handle.`,
  }),
  "server.target_without_slash": () => ({ problem: "the address does not begin with a slash" }),
  "script.welded": ({ vertices }) => ({
    problem: `${counted(vertices, "boundary vertex was welded to another", "boundary vertices were welded to others")} at the same position for the solve; the result keeps them separate`,
    remedy: "Switch off Weld seams to let such places separate.",
  }),
  "script.sha256_failed": () => ({ problem: "the checksum of the file cannot be computed" }),
  "script.wrong_sha256": ({ file }) => ({
    problem: `the file ${file} is not the one that the edit was made for`,
    remedy: "Put the earlier file back in its place.",
  }),
};
