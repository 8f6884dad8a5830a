import { useEffect, useRef } from "preact/hooks";
import type { Editor } from "../app/editor";
import type { Viewport } from "../view/viewport";

/** The whole page: the view, and the panels around it. */
export function App({ editor, viewport }: { editor: Editor; viewport: Viewport }) {
  const host = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (host.current !== null) viewport.attach(host.current);
  }, [viewport]);
  const samples = editor.welcome.value?.samples ?? [];
  return (
    <main>
      <div class="view" ref={host} />
      {!editor.isOpen.value && (
        <ul class="start">
          {samples.map((sample) => (
            <li key={sample.name}>
              <button type="button" onClick={() => void editor.ask({ do: "open", sample: sample.name })}>
                {sample.name}
              </button>
            </li>
          ))}
        </ul>
      )}
    </main>
  );
}
