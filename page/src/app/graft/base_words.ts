import type { FactFields, FactId } from "../../facts";
import { counted, formatNumber } from "../units";

const anotherBase = "Drag Base to another height, or cut the part open first.";

/** The page's words on the bases at which closed parts are cut open. */
export const baseWords: { [Id in FactId]?: (fields: FactFields[Id]) => { problem?: string; remedy?: string } } = {
  "merge.base_cut": ({ loops, height }) => ({
    problem: `the part was cut open ${formatNumber(height, 4)} above its lowest point, in ${counted(loops, "loop")}`,
  }),
  "merge.closed_source_in_pieces": ({ pieces }) => ({
    problem: `the part is closed and consists of ${pieces} separate surfaces, which one cut cannot open`,
    remedy: "Drop them one by one, or unite them first in another program.",
  }),
  "merge.laid_on_another_side": () => ({
    problem: "the part does not go well on the side that it stands on there, so it was laid on another side; a smaller size or another place may help",
  }),
  "merge.base_cuts_open_chain": () => ({
    problem: "the plane that cuts the part open meets a hole of it",
    remedy: anotherBase,
  }),
  "merge.base_divides_source": ({ pieces }) => ({
    problem: `above the plane that cuts it open, the part falls into ${counted(pieces, "piece", "pieces")}`,
    remedy: anotherBase,
  }),
  "merge.base_has_too_many_loops": ({ loops }) => ({
    problem: `the plane that cuts the part open makes ${counted(loops, "loop", "loops")}, which is too many`,
    remedy: anotherBase,
  }),
  "merge.base_height_outside": ({ height, extent }) => ({
    problem: `a base ${formatNumber(height, 4)} above its lowest point is outside the part`,
    remedy: `Use a base between 0 and ${formatNumber(extent, 4)}.`,
  }),
  "merge.base_is_hollow": () => ({
    problem: "the part is hollow where it would be cut open",
    remedy: `${anotherBase} To keep the hollow, unite both meshes by a Boolean union in another program.`,
  }),
  "merge.base_loop_without_area": () => ({
    problem: "one of the loops in which the part would be cut open has hardly any area",
    remedy: anotherBase,
  }),
  "merge.base_misses_source": () => ({
    problem: "the plane that should cut the part open misses it",
    remedy: anotherBase,
  }),
  "merge.base_takes_much": ({ percent }) => ({
    problem: `what was cut off as its base has ${formatNumber(percent, 2, 0)} % of the part's vertices; a lower base keeps more`,
  }),
  "merge.fewer_feet_used": ({ feet, used }) => ({
    problem: `the part does not stand well on its ${counted(feet, "foot", "feet")} there, so it is cut higher, in ${counted(used, "loop", "loops")}`,
  }),
  "merge.foot_beside_surface": ({ size }) => ({
    problem: `a foot of the part would stand beside the model's surface, at size ${formatNumber(size, 3)}`,
  }),
  "merge.feet_too_close": ({ size }) => ({
    problem: `the holes for two feet of the part would meet, at size ${formatNumber(size, 3)}`,
  }),
  "merge.base_with_source_loop": () => ({
    problem: "a part is either cut open at its base or joined at one of its loops",
    remedy: "Name one of the two.",
  }),
  "merge.no_base": () => ({
    problem: "the part is closed and has no side where a plane cuts it in clean round loops",
    remedy:
      "Cut it open first. If the two solids shall only overlap, unite them by a Boolean union in another program.",
  }),
};
