import { Color, Group } from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import type { LoopRef, ShownLoop } from "../../app/graft/graft";
import type { Pair } from "../../app/graft/graft_step";
import { loopColour, pairColour, pickedColour, type Colour } from "../../app/graft/graft_colours";
import type { Viewport } from "../viewport";

/** The data that determine the colours of loops. */
export interface LoopLook {
  readonly pairs: readonly Pair[];
  readonly source: number | undefined;
  readonly target: number | undefined;
  readonly hovered: LoopRef | null;
  readonly picked: LoopRef | null;
}

interface DrawnLoop {
  readonly ref: LoopRef;
  readonly of: ShownLoop;
  readonly group: Group;
  readonly front: Line2;
  readonly behind: Line2;
}

/** Draws boundary loops as thick lines, faint where they are hidden. */
export class LoopLines {
  private drawn: DrawnLoop[] = [];

  constructor(private readonly viewport: Viewport) {}

  refs(): LoopRef[] {
    return this.drawn.map(({ ref }) => ref);
  }

  /** Shows these loops, given by mesh, and removes all others. */
  show(loops: ReadonlyMap<number, readonly ShownLoop[]>, look: LoopLook): void {
    const stays = this.drawn.filter(({ ref, of }) => loops.get(ref.mesh)?.[ref.loop] === of);
    for (const gone of this.drawn) if (!stays.includes(gone)) dispose(gone);
    this.drawn = stays;
    for (const [mesh, all] of loops)
      all.forEach((of, loop) => {
        if (!stays.some(({ ref }) => ref.mesh === mesh && ref.loop === loop)) this.draw({ mesh, loop }, of);
      });
    for (const one of this.drawn) this.paint(one, look);
  }

  private draw(ref: LoopRef, of: ShownLoop): void {
    const surface = this.viewport.surfaceOf(ref.mesh);
    if (surface === undefined || of.vertices.length < 2) return;
    const positions = new Float32Array(3 * (of.vertices.length + 1));
    for (let i = 0; i <= of.vertices.length; ++i)
      for (let k = 0; k < 3; ++k)
        positions[3 * i + k] = surface.positions[3 * (of.vertices[i % of.vertices.length] as number) + k] ?? 0;
    const geometry = new LineGeometry().setPositions(positions);
    const front = new Line2(geometry, new LineMaterial({ linewidth: 4 }));
    const behind = new Line2(geometry, new LineMaterial({ linewidth: 3, transparent: true, opacity: 0.25, depthTest: false }));
    const group = new Group();
    group.position.copy(surface.object.position);
    group.add(behind, front);
    front.renderOrder = 2;
    behind.renderOrder = 1;
    (this.viewport.parts.get(ref.mesh)?.loops ?? this.viewport.scene).add(group);
    this.drawn.push({ ref, of, group, front, behind });
  }

  private paint({ ref, front, behind }: DrawnLoop, look: LoopLook): void {
    const isRef = (other: LoopRef | null) => other?.mesh === ref.mesh && other.loop === ref.loop;
    const lit = isRef(look.hovered) || isRef(look.picked);
    const colour = new Color(...this.colourOf(ref, look));
    if (isRef(look.hovered)) colour.lerp(new Color(1, 1, 1), 0.35);
    for (const line of [front, behind]) line.material.color.copy(colour);
    front.material.linewidth = lit ? 7 : 4;
    behind.material.opacity = lit ? 0.6 : 0.25;
  }

  private colourOf(ref: LoopRef, { pairs, source, target, picked }: LoopLook): Colour {
    if (picked?.mesh === ref.mesh && picked.loop === ref.loop) return pickedColour;
    const pair = pairs.findIndex(
      ({ sourceLoop, targetLoop }) =>
        (ref.mesh === source && ref.loop === sourceLoop) || (ref.mesh === target && ref.loop === targetLoop),
    );
    return pair < 0 ? loopColour : pairColour(pair);
  }
}

function dispose({ group, front, behind }: DrawnLoop): void {
  group.removeFromParent();
  front.geometry.dispose();
  front.material.dispose();
  behind.material.dispose();
}
